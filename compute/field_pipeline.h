// The field kernel specialised to what one scene uses. Vulkan types: for compute/*.cpp only.
#pragma once

#include "compute/pipelines.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

enum class FieldVariant { f32, f32_packed, f64 };

/// What a pipeline is compiled for.
struct FieldSpecialization {
    FieldVariant variant = FieldVariant::f32;
    std::uint32_t group = 0; /* invocations of a work group */
    layout::Features features;
};

/// Pipelines that take layout::ChunkParams and the bindings layout::kBind...
Pipelines make_field_pipelines(Device::Implementation& device);

/// The pipeline for a scene, compiled if it was not yet.
vk::Pipeline field_pipeline(Pipelines& pipelines, const FieldSpecialization& specialization);

} // namespace forceshade::compute
