#include <fmt/format.h>

#include "compute/vulkan.h"

namespace forceshade::compute {
namespace {

using Flags = vk::MemoryPropertyFlags;
using Flag = vk::MemoryPropertyFlagBits;

// Wishes in falling order; the first that some allowed memory type meets is taken.
std::vector<Flags> wishes(Placement placement) {
    switch (placement) {
    case Placement::device:
        return {Flag::eDeviceLocal, Flags{}};
    case Placement::host_upload:
        return {Flag::eHostVisible | Flag::eHostCoherent, Flag::eHostVisible};
    case Placement::host_read:
        return {Flag::eHostVisible | Flag::eHostCached | Flag::eHostCoherent, Flag::eHostVisible | Flag::eHostCached,
                Flag::eHostVisible};
    }
    return {};
}

std::optional<std::uint32_t> memory_type(const vk::PhysicalDeviceMemoryProperties& memory, std::uint32_t allowed,
                                         Flags wanted) {
    for (std::uint32_t type = 0; type < memory.memoryTypeCount; ++type)
        if ((allowed & (1u << type)) && (memory.memoryTypes[type].propertyFlags & wanted) == wanted)
            return type;
    return std::nullopt;
}

} // namespace

Buffer make_buffer(Device::Implementation& device, std::size_t bytes, vk::BufferUsageFlags usage, Placement placement) {
    const std::string doing = fmt::format("allocating a buffer of {} bytes", bytes);
    return checked(doing, [&] {
        Buffer result;
        result.size = std::max<std::size_t>(bytes, 16);
        result.buffer = device.device.createBuffer({{}, result.size, usage, vk::SharingMode::eExclusive});
        const vk::MemoryRequirements needs = result.buffer.getMemoryRequirements();
        for (const Flags wanted : wishes(placement)) {
            const auto type = memory_type(device.memory, needs.memoryTypeBits, wanted);
            if (!type)
                continue;
            if (needs.size > device.memory.memoryHeaps[device.memory.memoryTypes[*type].heapIndex].size)
                continue;
            const Flags flags = device.memory.memoryTypes[*type].propertyFlags;
            result.memory = device.device.allocateMemory({needs.size, *type});
            result.buffer.bindMemory(*result.memory, 0);
            result.coherent = bool(flags & Flag::eHostCoherent);
            if (placement != Placement::device)
                result.mapped = static_cast<std::byte*>(result.memory.mapMemory(0, VK_WHOLE_SIZE));
            return result;
        }
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("no memory type of the device holds a buffer of {} bytes", bytes));
    });
}

bool shares_memory_with_host(const Device::Implementation& device) {
    return device.report.software || device.report.type == "integrated";
}

} // namespace forceshade::compute
