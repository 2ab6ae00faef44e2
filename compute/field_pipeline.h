// The field kernel specialised to what one scene uses. Vulkan types: for compute/*.cpp only.
#pragma once

#include <array>

#include "compute/vulkan.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

enum class FieldVariant { f32, f32_packed, f64 };

/// What a pipeline is compiled for.
struct FieldSpecialization {
    FieldVariant variant = FieldVariant::f32;
    std::uint32_t group = 0; /* invocations of a work group */
    layout::Features features;
    friend bool operator==(const FieldSpecialization&, const FieldSpecialization&) = default;
};

/// Compiles field pipelines, each once.
class FieldPipelines {
public:
    explicit FieldPipelines(Device::Implementation& device);

    vk::Pipeline get(const FieldSpecialization& specialization);
    const vk::raii::DescriptorSetLayout& set_layout() const { return set_layout_; }
    const vk::raii::PipelineLayout& layout() const { return layout_; }

private:
    struct Compiled {
        FieldSpecialization specialization;
        vk::raii::Pipeline pipeline;
    };
    Device::Implementation& device_;
    vk::raii::DescriptorSetLayout set_layout_{nullptr};
    vk::raii::PipelineLayout layout_{nullptr};
    std::array<vk::raii::ShaderModule, 3> modules_{vk::raii::ShaderModule{nullptr}, vk::raii::ShaderModule{nullptr},
                                                   vk::raii::ShaderModule{nullptr}};
    std::vector<Compiled> compiled_;
};

} // namespace forceshade::compute
