#include "compute/field_pipeline.h"

#include <array>

#include "shaders/kernels.h"

namespace forceshade::compute {
namespace {

std::span<const std::uint32_t> words(FieldVariant variant) {
    switch (variant) {
    case FieldVariant::f32:
        return kernels::field_f32();
    case FieldVariant::f32_packed:
        return kernels::field_f32_packed();
    case FieldVariant::f64:
        return kernels::field_f64();
    }
    return {};
}

std::array<std::uint32_t, layout::kSpecCount> constants(const FieldSpecialization& specialization) {
    std::array<std::uint32_t, layout::kSpecCount> values{};
    values[layout::kSpecLocalX] = specialization.group;
    values[layout::kSpecSurface] = specialization.features.surface;
    values[layout::kSpecShading] = specialization.features.shading;
    values[layout::kSpecDepth] = specialization.features.depth;
    values[layout::kSpecReference] = specialization.features.reference;
    values[layout::kSpecMap] = specialization.features.map;
    values[layout::kSpecTexture] = specialization.features.texture;
    values[layout::kSpecChannels] = specialization.features.channels;
    return values;
}

} // namespace

Pipelines make_field_pipelines(Device::Implementation& device) {
    return Pipelines(device, layout::kBindCount, sizeof(layout::ChunkParams));
}

vk::Pipeline field_pipeline(Pipelines& pipelines, const FieldSpecialization& specialization) {
    return pipelines.get(words(specialization.variant), constants(specialization));
}

} // namespace forceshade::compute
