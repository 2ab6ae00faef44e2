// The mesh kernel specialised to what one scene uses. Vulkan types: for compute/*.cpp only.
#pragma once

#include "compute/pipelines.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// Invocations of a work group.
constexpr std::uint32_t kMeshGroup = 64;

/// Pipelines that take layout::MeshChunkParams and the bindings layout::kMeshBind...
Pipelines make_mesh_pipelines(Device::Implementation& device);

/// The pipeline for a scene in a precision, compiled if it was not yet; or the one that writes proxies of free voxels.
vk::Pipeline mesh_pipeline(Pipelines& pipelines, const layout::Features& features, bool f64);
vk::Pipeline free_proxy_pipeline(Pipelines& pipelines, bool f64);

} // namespace forceshade::compute
