#include "compute/mesh_pipeline.h"

#include <array>

#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

vk::Pipeline get(Pipelines& pipelines, const layout::Features& features, bool f64, bool free) {
    std::array<std::uint32_t, layout::kMeshSpecCount> values{};
    values[layout::kMeshSpecLocalX] = kMeshGroup;
    values[layout::kMeshSpecShading] = features.shading;
    values[layout::kMeshSpecInside] = features.inside;
    values[layout::kMeshSpecMap] = features.map;
    values[layout::kMeshSpecTexture] = features.texture;
    values[layout::kMeshSpecChannels] = features.channels;
    values[layout::kMeshSpecFree] = free;
    values[layout::kMeshSpecUnroll] = 1;
    return pipelines.get(f64 ? kernels::mesh_field_f64() : kernels::mesh_field_f32(), values);
}

} // namespace

Pipelines make_mesh_pipelines(Device::Implementation& device) {
    return Pipelines(device, layout::kMeshBindCount, sizeof(layout::MeshChunkParams));
}

vk::Pipeline mesh_pipeline(Pipelines& pipelines, const layout::Features& features, bool f64) {
    return get(pipelines, features, f64, false);
}

vk::Pipeline free_proxy_pipeline(Pipelines& pipelines, bool f64) {
    layout::Features features;
    features.channels = layout::kChannelProxy;
    return get(pipelines, features, f64, true);
}

} // namespace forceshade::compute
