// The mesh kernel specialised to what one scene uses. Vulkan types: for compute/*.cpp only.
#pragma once

#include "compute/pipelines.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// Invocations of a work group.
constexpr std::uint32_t kMeshGroup = 64;

/// Pipelines that take layout::MeshChunkParams and the bindings layout::kMeshBind...
Pipelines make_mesh_pipelines(Device::Implementation& device);

/// How kernels go round facets with many corners, so that drivers do not end their loops.
struct FacetLoops {
    std::uint32_t unroll = 1;    /* corners an iteration */
    bool voxel_by_voxel = false; /* an invocation evaluates one voxel of a block */
};

/// \throws DeviceError (unsupported) where a facet has more corners than any way of going round it allows.
FacetLoops facet_loops(const layout::Features& features, std::span<const layout::uint> facet_begins);

/// The pipeline for a scene in a precision, compiled if it was not yet; or the one that writes proxies of free voxels.
vk::Pipeline mesh_pipeline(Pipelines& pipelines, const layout::Features& features, FacetLoops loops, bool f64);
vk::Pipeline free_proxy_pipeline(Pipelines& pipelines, bool f64);

} // namespace forceshade::compute
