// Memory of the device and buffers in it, and commands.
#include <algorithm>
#include <cstring>

#include <fmt/format.h>

#include "compute/plan.h"
#include "compute/vulkan.h"

namespace forceshade::compute {
namespace {

constexpr std::size_t kLarge = std::size_t(1) << 20; // bytes: a buffer has memory of its own
constexpr std::size_t kPiece = std::size_t(2) << 20; // that smaller ones share

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

std::shared_ptr<MemoryPiece> make_piece(Device::Implementation& device, std::uint32_t type, bool mapped,
                                        std::size_t bytes) {
    auto piece = std::make_shared<MemoryPiece>();
    if (device.taken.memory != 0 && !mapped) {
        if (device.allocated + bytes > device.taken.memory)
            throw vk::OutOfDeviceMemoryError(kLimitsVariable);
        device.allocated += bytes;
        piece->counted = {nullptr, [&device, bytes](void*) { device.allocated -= bytes; }};
    }
    piece->memory = device.device.allocateMemory({bytes, type});
    if (mapped)
        piece->mapped = static_cast<std::byte*>(piece->memory.mapMemory(0, VK_WHOLE_SIZE));
    piece->free.emplace(0, bytes);
    return piece;
}

void give_back(MemoryPiece& piece, std::size_t offset, std::size_t bytes) {
    const auto after = piece.free.find(offset + bytes);
    if (after != piece.free.end()) {
        bytes += after->second;
        piece.free.erase(after);
    }
    const auto next = piece.free.lower_bound(offset);
    if (next != piece.free.begin())
        if (const auto before = std::prev(next); before->first + before->second == offset) {
            before->second += bytes;
            return;
        }
    piece.free.emplace(offset, bytes);
}

// Null if there is no room. `bytes` is a multiple of `alignment`.
std::shared_ptr<const Part> take_from(const std::shared_ptr<MemoryPiece>& piece, std::size_t bytes,
                                      std::size_t alignment) {
    for (const auto& [begin, room] : piece->free) {
        const std::size_t offset = divide_up(begin, alignment) * alignment, end = begin + room;
        if (offset + bytes > end)
            continue;
        const std::size_t first = begin;
        piece->free.erase(first);
        if (offset > first)
            piece->free.emplace(first, offset - first);
        if (offset + bytes < end)
            piece->free.emplace(offset + bytes, end - offset - bytes);
        return {new Part{piece, offset, bytes}, [](const Part* part) {
                    give_back(*part->piece, part->offset, part->bytes);
                    delete part;
                }};
    }
    return nullptr;
}

std::shared_ptr<const Part> take_memory(Device::Implementation& device, std::uint32_t type, bool mapped,
                                        const vk::MemoryRequirements& needs) {
    // Parts that are flushed alone.
    const std::size_t alignment = std::max<std::size_t>(needs.alignment, device.limits.nonCoherentAtomSize);
    const std::size_t bytes = divide_up(needs.size, alignment) * alignment;
    if (bytes >= kLarge)
        return take_from(make_piece(device, type, mapped, bytes), bytes, 1);
    auto& pieces = device.pieces[{type, mapped}];
    for (const std::shared_ptr<MemoryPiece>& piece : pieces)
        if (auto part = take_from(piece, bytes, alignment))
            return part;
    return take_from(pieces.emplace_back(make_piece(device, type, mapped, kPiece)), bytes, alignment);
}

vk::MappedMemoryRange range_of(const Buffer& buffer) {
    const Part& part = *buffer.memory;
    return {*part.piece->memory, part.offset, part.bytes < kLarge ? part.bytes : VK_WHOLE_SIZE};
}

} // namespace

Buffer make_buffer(Device::Implementation& device, std::size_t bytes, vk::BufferUsageFlags usage, Placement placement) {
    const std::string doing = fmt::format("allocating a buffer of {} bytes", bytes);
    return checked(doing, [&] {
        if (device.taken.short_at != 0 && ++device.buffers == device.taken.short_at)
            throw vk::OutOfDeviceMemoryError(kLimitsVariable);
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
            const bool mapped = placement != Placement::device;
            result.memory = take_memory(device, *type, mapped, needs);
            result.buffer.bindMemory(*result.memory->piece->memory, result.memory->offset);
            result.coherent = bool(device.memory.memoryTypes[*type].propertyFlags & Flag::eHostCoherent);
            if (!mapped)
                return result;
            result.mapped = result.memory->piece->mapped + result.memory->offset;
            if (device.taken.incoherent) {
                result.coherent = false;
                result.apart.assign(result.size, std::byte{0xA5});
                result.behind = std::exchange(result.mapped, result.apart.data());
            }
            return result;
        }
        throw DeviceError(DeviceError::Kind::out_of_memory,
                          fmt::format("no memory type of the device holds a buffer of {} bytes", bytes));
    });
}

void flush_to_device(Device::Implementation& device, const Buffer& buffer) {
    if (buffer.behind)
        std::memcpy(buffer.behind, buffer.mapped, buffer.size);
    if (!buffer.coherent)
        device.device.flushMappedMemoryRanges(range_of(buffer));
}

const std::byte* visible_to_host(Device::Implementation& device, const Buffer& buffer) {
    if (!buffer.coherent)
        device.device.invalidateMappedMemoryRanges(range_of(buffer));
    if (buffer.behind)
        std::memcpy(buffer.mapped, buffer.behind, buffer.size);
    return buffer.mapped;
}

Commands::Commands(Device::Implementation& device)
    : device_(&device),
      pool_(device.device.createCommandPool({vk::CommandPoolCreateFlagBits::eTransient, device.queue_family})),
      buffer_(std::move(device.device.allocateCommandBuffers({*pool_, vk::CommandBufferLevel::ePrimary, 1}).front())),
      fence_(device.device.createFence({})) {}

void Commands::submit() {
    if (device_->taken.lost_at != 0 && ++device_->submissions >= device_->taken.lost_at)
        throw vk::DeviceLostError(kLimitsVariable);
    device_->device.resetFences(*fence_);
    device_->queue.submit(vk::SubmitInfo({}, {}, *buffer_), *fence_);
}

void Commands::wait() {
    // Dispatches of hardware take a fraction of a second; software has no driver that would end a long one.
    constexpr std::uint64_t kStep = 2'000'000'000, kPatience = 60 * kStep / 2; // ns
    for (std::uint64_t waited = 0; device_->device.waitForFences(*fence_, true, kStep) != vk::Result::eSuccess;
         waited += kStep)
        if (!device_->report.software && waited >= kPatience)
            throw DeviceError(DeviceError::Kind::device_lost,
                              "the device did not finish its work within a minute: its driver hangs, or other programs "
                              "keep it busy; run again, or choose another with --gpu");
}

} // namespace forceshade::compute
