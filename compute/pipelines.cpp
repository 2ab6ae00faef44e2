#include "compute/pipelines.h"

#include <algorithm>

namespace forceshade::compute {

Pipelines::Pipelines(Device::Implementation& device, std::uint32_t bindings, std::uint32_t push_bytes)
    : device_(device) {
    std::vector<vk::DescriptorSetLayoutBinding> buffers;
    for (std::uint32_t binding = 0; binding < bindings; ++binding)
        buffers.emplace_back(binding, vk::DescriptorType::eStorageBuffer, 1, vk::ShaderStageFlagBits::eCompute);
    checked("making the layout of a kernel", [&] {
        set_layout_ = device_.device.createDescriptorSetLayout({{}, buffers});
        const vk::PushConstantRange push(vk::ShaderStageFlagBits::eCompute, 0, push_bytes);
        layout_ = device_.device.createPipelineLayout({{}, *set_layout_, push});
    });
}

const vk::raii::ShaderModule& Pipelines::module_of(std::span<const std::uint32_t> code) {
    for (const Module& module : modules_)
        if (module.code == code.data())
            return module.module;
    modules_.push_back({code.data(), device_.device.createShaderModule({{}, code.size_bytes(), code.data()})});
    return modules_.back().module;
}

vk::Pipeline Pipelines::get(std::span<const std::uint32_t> code, std::span<const std::uint32_t> constants) {
    for (const Compiled& compiled : compiled_)
        if (compiled.code == code.data() && std::ranges::equal(compiled.constants, constants))
            return *compiled.pipeline;
    return checked("compiling a kernel", [&] {
        std::vector<vk::SpecializationMapEntry> entries;
        for (std::uint32_t id = 0; id < constants.size(); ++id)
            entries.emplace_back(id, id * std::uint32_t(sizeof(std::uint32_t)), sizeof(std::uint32_t));
        const vk::SpecializationInfo info(static_cast<std::uint32_t>(entries.size()), entries.data(),
                                          constants.size_bytes(), constants.data());
        const vk::PipelineShaderStageCreateInfo stage({}, vk::ShaderStageFlagBits::eCompute, *module_of(code), "main",
                                                      &info);
        compiled_.push_back({code.data(),
                             {constants.begin(), constants.end()},
                             device_.device.createComputePipeline(device_.pipeline_cache, {{}, stage, *layout_})});
        return *compiled_.back().pipeline;
    });
}

} // namespace forceshade::compute
