// Tables that a kernel reads, on the device. For compute/*.cpp only.
#pragma once

#include <vector>

#include "compute/vulkan.h"

namespace forceshade::compute {

class InputBuffers {
public:
    /// For the bindings 0 to `bindings` - 1.
    InputBuffers(Device::Implementation& device, std::size_t bindings);

    /// Copies a table; an empty one leaves what was there. Buffers are kept and grow. \throws DeviceError
    /// (out_of_memory) for a table beyond the device's range.
    void upload(std::size_t binding, std::span<const std::byte> bytes);

    /// The buffer of a binding; a small one where nothing was uploaded.
    vk::Buffer buffer(std::size_t binding) const;

    /// Bytes copied so far, of all tables together.
    std::uint64_t uploaded() const { return uploaded_; }

private:
    Device::Implementation& device_;
    Buffer nothing_; // bound where a kernel uses no buffer
    std::vector<Buffer> buffers_;
    std::uint64_t uploaded_ = 0;
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
