#include "compute/input_buffers.h"

#include <cstring>

#include <fmt/format.h>

namespace forceshade::compute {

void grow(Device::Implementation& device, Buffer& buffer, std::size_t bytes, vk::BufferUsageFlags usage,
          Placement placement) {
    if (buffer.size >= bytes)
        return;
    buffer = Buffer{}; // before the new one, so that both need not fit
    buffer = make_buffer(device, bytes, usage, placement);
}

void wait_for(Device::Implementation& device, const vk::raii::Fence& fence) {
    if (device.device.waitForFences(*fence, true, UINT64_MAX) != vk::Result::eSuccess)
        throw DeviceError(DeviceError::Kind::device_lost, "the device did not finish its work");
}

vk::raii::CommandBuffer make_commands(Device::Implementation& device) {
    return std::move(
        device.device.allocateCommandBuffers({*device.command_pool, vk::CommandBufferLevel::ePrimary, 1}).front());
}

void flush_to_device(Device::Implementation& device, const Buffer& buffer) {
    if (!buffer.coherent)
        device.device.flushMappedMemoryRanges(vk::MappedMemoryRange(*buffer.memory, 0, VK_WHOLE_SIZE));
}

const std::byte* visible_to_host(Device::Implementation& device, const Buffer& buffer) {
    if (!buffer.coherent)
        device.device.invalidateMappedMemoryRanges(vk::MappedMemoryRange(*buffer.memory, 0, VK_WHOLE_SIZE));
    return buffer.mapped;
}

InputBuffers::InputBuffers(Device::Implementation& device, std::size_t bindings)
    : device_(device), nothing_(make_buffer(device, 16, vk::BufferUsageFlagBits::eStorageBuffer, Placement::device)),
      buffers_(bindings), commands_(make_commands(device)), fence_(device.device.createFence({})) {}

vk::Buffer InputBuffers::buffer(std::size_t binding) const {
    return binding < buffers_.size() && buffers_[binding].size ? *buffers_[binding].buffer : *nothing_.buffer;
}

void InputBuffers::upload(std::size_t binding, std::span<const std::byte> bytes) {
    using Usage = vk::BufferUsageFlagBits;
    if (bytes.empty())
        return;
    if (bytes.size() > device_.limits.maxStorageBufferRange)
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("a table of the scene takes {} bytes and a buffer of this device spans {}: fewer "
                                      "facets, a smaller height map or a smaller grid would fit",
                                      bytes.size(), device_.limits.maxStorageBufferRange));
    const Buffer staging = make_buffer(device_, bytes.size(), Usage::eTransferSrc, Placement::host_upload);
    std::memcpy(staging.mapped, bytes.data(), bytes.size());
    flush_to_device(device_, staging);
    grow(device_, buffers_[binding], bytes.size(), Usage::eStorageBuffer | Usage::eTransferDst, Placement::device);
    commands_.reset();
    commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    commands_.copyBuffer(*staging.buffer, *buffers_[binding].buffer, vk::BufferCopy(0, 0, bytes.size()));
    const vk::MemoryBarrier written(vk::AccessFlagBits::eTransferWrite, vk::AccessFlagBits::eShaderRead);
    commands_.pipelineBarrier(vk::PipelineStageFlagBits::eTransfer, vk::PipelineStageFlagBits::eComputeShader, {},
                              written, {}, {});
    commands_.end();
    device_.device.resetFences(*fence_);
    device_.queue.submit(vk::SubmitInfo({}, {}, *commands_), *fence_);
    wait_for(device_, fence_);
    uploaded_ += bytes.size();
}

} // namespace forceshade::compute
