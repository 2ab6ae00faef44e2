#include "compute/path_pipeline.h"

#include <array>

#include "shaders/kernels.h"

namespace forceshade::compute {

Pipelines make_path_pipelines(Device::Implementation& device) {
    return Pipelines(device, layout::kPathBindCount, sizeof(layout::PathChunkParams));
}

vk::Pipeline path_pipeline(Pipelines& pipelines, const PathSpecialization& specialization) {
    const bool closed = specialization.features.loop == layout::kLoopClosed;
    std::array<std::uint32_t, layout::kPathSpecCount> values{};
    values[layout::kPathSpecLocalX] = kPathGroup;
    values[layout::kPathSpecSurface] = specialization.law.surface;
    values[layout::kPathSpecShading] = specialization.law.shading;
    values[layout::kPathSpecDepth] = specialization.law.depth;
    values[layout::kPathSpecReference] = specialization.law.reference;
    values[layout::kPathSpecMap] = specialization.law.map;
    values[layout::kPathSpecTexture] = specialization.law.texture;
    values[layout::kPathSpecChannels] = specialization.features.channels;
    values[layout::kPathSpecMotion] = specialization.features.motion;
    values[layout::kPathSpecLoop] = specialization.features.loop;
    values[layout::kPathSpecFollow] = specialization.features.follow;
    values[layout::kPathSpecHarmonics] = specialization.features.harmonics;
    values[layout::kPathSpecFriction] = closed && specialization.hands.friction;
    values[layout::kPathSpecQuantised] = closed && specialization.hands.quantised;
    return pipelines.get(specialization.f64 ? kernels::path_f64() : kernels::path_f32(), values);
}

} // namespace forceshade::compute
