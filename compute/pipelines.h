// Compute pipelines of one kernel, compiled once for each set of specialization constants. Vulkan types: for
// compute/*.cpp only.
#pragma once

#include <span>
#include <vector>

#include "compute/vulkan.h"

namespace forceshade::compute {

class Pipelines {
public:
    /// Kernels with `bindings` storage buffers in set 0 and `push_bytes` of push constants.
    Pipelines(Device::Implementation& device, std::uint32_t bindings, std::uint32_t push_bytes);

    /// `code` is SPIR-V that outlives this; `constants` stand by their ids, from 0.
    vk::Pipeline get(std::span<const std::uint32_t> code, std::span<const std::uint32_t> constants);
    const vk::raii::DescriptorSetLayout& set_layout() const { return set_layout_; }
    const vk::raii::PipelineLayout& layout() const { return layout_; }

private:
    struct Module {
        const std::uint32_t* code;
        vk::raii::ShaderModule module;
    };
    struct Compiled {
        const std::uint32_t* code;
        std::vector<std::uint32_t> constants;
        vk::raii::Pipeline pipeline;
    };
    const vk::raii::ShaderModule& module_of(std::span<const std::uint32_t> code);

    Device::Implementation& device_;
    vk::raii::DescriptorSetLayout set_layout_{nullptr};
    vk::raii::PipelineLayout layout_{nullptr};
    std::vector<Module> modules_;
    std::vector<Compiled> compiled_;
};

} // namespace forceshade::compute
