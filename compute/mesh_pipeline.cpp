#include "compute/mesh_pipeline.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>

#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

// Software drivers end the loops of an invocation after 65 535 iterations, in silence; this is far from there.
constexpr std::uint32_t kMostIterations = 24000;
constexpr std::uint32_t kUnroll = 8;
constexpr std::uint32_t kBlockVoxels = layout::kMeshBlock * layout::kMeshBlock * layout::kMeshBlock;

vk::Pipeline get(Pipelines& pipelines, const layout::Features& features, FacetLoops loops, bool f64, bool free) {
    std::array<std::uint32_t, layout::kMeshSpecCount> values{};
    values[layout::kMeshSpecLocalX] = kMeshGroup;
    values[layout::kMeshSpecShading] = features.shading;
    values[layout::kMeshSpecInside] = features.inside;
    values[layout::kMeshSpecMap] = features.map;
    values[layout::kMeshSpecTexture] = features.texture;
    values[layout::kMeshSpecChannels] = features.channels;
    values[layout::kMeshSpecFree] = free;
    values[layout::kMeshSpecUnroll] = loops.unroll;
    return pipelines.get(f64 ? kernels::mesh_field_f64() : kernels::mesh_field_f32(), values);
}

} // namespace

Pipelines make_mesh_pipelines(Device::Implementation& device) {
    return Pipelines(device, layout::kMeshBindCount, sizeof(layout::MeshChunkParams));
}

FacetLoops facet_loops(const layout::Features& features, std::span<const layout::uint> facet_begins) {
    if (features.shading == layout::kShadingNone || features.shading == layout::kShadingBarycentric)
        return {};
    layout::uint most = 0;
    for (std::size_t f = 0; f + 1 < facet_begins.size(); ++f)
        most = std::max(most, facet_begins[f + 1] - facet_begins[f]);
    if (most <= kMostIterations / kBlockVoxels)
        return {};
    if (most > kMostIterations * kUnroll)
        throw DeviceError(DeviceError::Kind::unsupported,
                          fmt::format("a facet of the mesh has {} corners and kernels interpolate over at most {}: use "
                                      "--engine cpu, or cut the facet",
                                      most, kMostIterations * kUnroll));
    return {kUnroll, true};
}

vk::Pipeline mesh_pipeline(Pipelines& pipelines, const layout::Features& features, FacetLoops loops, bool f64) {
    return get(pipelines, features, loops, f64, false);
}

vk::Pipeline free_proxy_pipeline(Pipelines& pipelines, bool f64) {
    layout::Features features;
    features.channels = layout::kChannelProxy;
    return get(pipelines, features, {}, f64, true);
}

} // namespace forceshade::compute
