// The kernel of paths specialised to what one scene uses. Vulkan types: for compute/*.cpp only.
#pragma once

#include "compute/path_inputs.h"
#include "compute/pipelines.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// Invocations of a work group.
constexpr std::uint32_t kPathGroup = 32;

/// What a pipeline is compiled for.
struct PathSpecialization {
    layout::Features law;
    layout::PathFeatures features;
    HandFeatures hands;
    bool f64 = false;
};

/// Pipelines that take layout::PathChunkParams and the bindings layout::kPathBind...
Pipelines make_path_pipelines(Device::Implementation& device);

/// The pipeline for a scene, compiled if it was not yet.
vk::Pipeline path_pipeline(Pipelines& pipelines, const PathSpecialization& specialization);

} // namespace forceshade::compute
