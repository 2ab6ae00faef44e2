// What the field kernel reads: the law, the axes and the tables of a scene, on the device. For compute/*.cpp only.
#pragma once

#include <array>

#include "compute/vulkan.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

class FieldInputs {
public:
    explicit FieldInputs(Device::Implementation& device);

    /// Uploads everything a field reads; rows of the x axis are padded with their last sample to a multiple of
    /// `abreast`. Buffers are kept from field to field and grow. \throws DeviceError (out_of_memory) for a table beyond
    /// the device's range.
    template <typename T> void upload(const layout::FieldInput<T>& input, std::uint32_t abreast);

    /// The buffer of a binding below layout::kBindStatus; a small one where the scene has none.
    vk::Buffer buffer(layout::uint binding) const;

private:
    void upload_bytes(layout::uint binding, std::span<const std::byte> bytes);

    Device::Implementation& device_;
    Buffer nothing_; // bound where a kernel uses no buffer
    std::array<Buffer, layout::kBindStatus> buffers_;
    vk::raii::CommandBuffer commands_{nullptr};
    vk::raii::Fence fence_{nullptr};
};

/// Makes `buffer` hold at least `bytes`; what it held is lost if it grows.
void grow(Device::Implementation& device, Buffer& buffer, std::size_t bytes, vk::BufferUsageFlags usage,
          Placement placement);

/// \throws DeviceError (device_lost) unless the fence is signalled in the end.
void wait_for(Device::Implementation& device, const vk::raii::Fence& fence);

/// A command buffer of the device's pool.
vk::raii::CommandBuffer make_commands(Device::Implementation& device);

/// Writes of the host become visible to the device, and the other way round, where the memory is not coherent.
void flush_to_device(Device::Implementation& device, const Buffer& buffer);
const std::byte* visible_to_host(Device::Implementation& device, const Buffer& buffer);

} // namespace forceshade::compute
