#include "compute/field_pipeline.h"

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

FieldPipelines::FieldPipelines(Device::Implementation& device) : device_(device) {
    std::vector<vk::DescriptorSetLayoutBinding> bindings;
    for (std::uint32_t binding = 0; binding < layout::kBindCount; ++binding)
        bindings.emplace_back(binding, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
    checked("making the field pipelines' layout", [&] {
        set_layout_ = device_.device.createDescriptorSetLayout({{}, bindings});
        const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0, sizeof(layout::ChunkParams));
        layout_ = device_.device.createPipelineLayout({{}, *set_layout_, push});
    });
}

vk::Pipeline FieldPipelines::get(const FieldSpecialization& specialization) {
    for (const Compiled& compiled : compiled_)
        if (compiled.specialization == specialization)
            return *compiled.pipeline;
    return checked("compiling the field kernel", [&] {
        vk::raii::ShaderModule& module = modules_[static_cast<std::size_t>(specialization.variant)];
        if (!*module) {
            const auto code = words(specialization.variant);
            module = device_.device.createShaderModule({{}, code.size_bytes(), code.data()});
        }
        const auto values = constants(specialization);
        std::array<vk::SpecializationMapEntry, layout::kSpecCount> entries;
        for (std::uint32_t id = 0; id < entries.size(); ++id)
            entries[id] = vk::SpecializationMapEntry(id, id * sizeof(std::uint32_t), sizeof(std::uint32_t));
        const vk::SpecializationInfo info(static_cast<std::uint32_t>(entries.size()), entries.data(), sizeof(values),
                                          values.data());
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module, "main", &info);
        compiled_.push_back(
            {specialization, device_.device.createComputePipeline(device_.pipeline_cache, {{}, stage, *layout_})});
        return *compiled_.back().pipeline;
    });
}

} // namespace forceshade::compute
