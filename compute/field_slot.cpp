#include "compute/field_slot.h"

#include <cstring>
#include <utility>

namespace forceshade::compute {
namespace {

// The output channels in the order of SlotBindings::results.
struct Channel {
    layout::uint bit;
    std::uint32_t reals, uints; // a sample
};
constexpr std::array<Channel, FieldSlot::kChannelCount> kChannels{{{layout::kChannelForce, 3, 0},
                                                                   {layout::kChannelDepth, 1, 0},
                                                                   {layout::kChannelFacet, 0, 1},
                                                                   {layout::kChannelProxy, 3, 0},
                                                                   {layout::kChannelUnshaded, 3, 0}}};

std::size_t bytes_of(const Channel& channel, std::size_t samples, std::size_t real_size) {
    return samples * (channel.reals * real_size + channel.uints * sizeof(layout::uint));
}

// Timestamps of one dispatch: before the kernel, after it, after the copy.
constexpr std::uint32_t kTimestamps = 3;

} // namespace

FieldSlot::FieldSlot(Device::Implementation& device, const SlotBindings& bindings, vk::raii::DescriptorSet set,
                     bool staged)
    : device_(device), bindings_(bindings), staged_(staged),
      status_(make_buffer(device, sizeof(layout::uint), vk::BufferUsageFlagBits::eStorageBuffer, Placement::host_read)),
      set_(std::move(set)), commands_(make_commands(device)), fence_(device.device.createFence({})) {
    if (device.timestamp_bits)
        timestamps_ = device.device.createQueryPool({{}, vk::QueryType::eTimestamp, kTimestamps});
}

void FieldSlot::reserve(layout::uint channels, std::size_t samples, std::size_t real_size,
                        const std::function<vk::Buffer(layout::uint)>& inputs) {
    using Usage = vk::BufferUsageFlagBits;
    channels_ = channels;
    real_size_ = real_size;
    std::vector<vk::DescriptorBufferInfo> infos;
    for (layout::uint binding = 0; binding < bindings_.count; ++binding)
        infos.emplace_back(inputs(binding), 0, VK_WHOLE_SIZE);
    infos[bindings_.status].buffer = *status_.buffer;
    for (std::size_t c = 0; c < kChannels.size(); ++c) {
        if (!(channels & kChannels[c].bit))
            continue;
        const std::size_t bytes = bytes_of(kChannels[c], samples, real_size);
        grow(device_, results_[c], bytes, Usage::eStorageBuffer | Usage::eTransferSrc | Usage::eTransferDst,
             staged_ ? Placement::device : Placement::host_read);
        if (staged_)
            grow(device_, staging_[c], bytes, Usage::eTransferDst, Placement::host_read);
        infos[bindings_.results[c]].buffer = *results_[c].buffer;
    }
    device_.device.updateDescriptorSets(
        vk::WriteDescriptorSet(*set_, 0, 0, vk::DescriptorType::eStorageBuffer, {}, infos), {});
}

FieldSlot::Result FieldSlot::result(std::size_t channel) const {
    if (!(channels_ & kChannels[channel].bit))
        return {};
    return {*results_[channel].buffer, bytes_of(kChannels[channel], samples(), real_size_)};
}

void FieldSlot::record(const std::function<void(const vk::raii::CommandBuffer&)>& work) {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    const auto stamp = [&](std::uint32_t query) {
        if (device_.timestamp_bits)
            commands_.writeTimestamp(Stage::eBottomOfPipe, *timestamps_, query);
    };
    commands_.reset();
    commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
    if (device_.timestamp_bits)
        commands_.resetQueryPool(*timestamps_, 0, kTimestamps);
    stamp(0);
    work(commands_);
    stamp(1);
    if (staged_) {
        const vk::MemoryBarrier computed(Access::eShaderWrite | Access::eTransferWrite, Access::eTransferRead);
        commands_.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eTransfer, {}, computed, {}, {});
        for (std::size_t c = 0; c < kChannels.size(); ++c)
            if (const Result from = result(c); from.bytes)
                commands_.copyBuffer(from.buffer, *staging_[c].buffer, vk::BufferCopy(0, 0, from.bytes));
    }
    const vk::MemoryBarrier to_host(Access::eShaderWrite | Access::eTransferWrite, Access::eHostRead);
    commands_.pipelineBarrier(Stage::eComputeShader | Stage::eTransfer, Stage::eHost, {}, to_host, {}, {});
    stamp(2);
    commands_.end();
}

void FieldSlot::submit(const ChunkShape& chunk, const std::function<void(const vk::raii::CommandBuffer&)>& work) {
    chunk_ = chunk;
    record(work);
    std::memset(status_.mapped, 0, sizeof(layout::uint));
    flush_to_device(device_, status_);
    device_.device.resetFences(*fence_);
    submitted_ = std::chrono::steady_clock::now();
    device_.queue.submit(vk::SubmitInfo({}, {}, *commands_), *fence_);
    in_flight_ = true;
}

void FieldSlot::add_times(FieldTimes& times) {
    ++times.dispatches;
    if (!device_.timestamp_bits) {
        times.kernel += std::chrono::duration<double>(std::chrono::steady_clock::now() - submitted_).count();
        return;
    }
    const auto [result, stamps] = timestamps_.getResults<std::uint64_t>(
        0, kTimestamps, kTimestamps * sizeof(std::uint64_t), sizeof(std::uint64_t),
        vk::QueryResultFlagBits::e64 | vk::QueryResultFlagBits::eWait);
    if (result != vk::Result::eSuccess)
        return;
    const std::uint64_t mask = device_.timestamp_bits >= 64 ? ~0ull : (1ull << device_.timestamp_bits) - 1;
    const double tick = 1e-9 * static_cast<double>(device_.limits.timestampPeriod);
    times.kernel += tick * static_cast<double>((stamps[1] - stamps[0]) & mask);
    if (staged_)
        times.read_back += tick * static_cast<double>((stamps[2] - stamps[1]) & mask);
}

void FieldSlot::finish(FieldTimes& times) {
    if (!std::exchange(in_flight_, false))
        return;
    wait_for(device_, fence_);
    add_times(times);
    layout::uint status = 0;
    std::memcpy(&status, visible_to_host(device_, status_), sizeof(status));
    if (status & layout::kStatusUnfinished)
        throw DeviceError(DeviceError::Kind::unfinished,
                          "the device's driver ended a loop of the kernel before its work was done; nothing of this "
                          "field can be trusted");
}

template <typename Value> std::span<const Value> FieldSlot::channel(std::size_t which, std::size_t values_a_sample) {
    if (!(channels_ & kChannels[which].bit))
        return {};
    const std::byte* const bytes = visible_to_host(device_, (staged_ ? staging_ : results_)[which]);
    return {reinterpret_cast<const Value*>(bytes), samples() * values_a_sample};
}

template <typename T> layout::FieldChunk<T> FieldSlot::results(std::size_t x_count) {
    layout::FieldChunk<T> chunk{};
    chunk.x_count = x_count;
    chunk.x_pitch = chunk_.x_pitch;
    chunk.y_first = chunk_.y_first;
    chunk.y_count = chunk_.y_count;
    chunk.z_first = chunk_.z_first;
    chunk.z_count = chunk_.z_count;
    chunk.force = channel<T>(0, 3);
    chunk.depth = channel<T>(1, 1);
    chunk.facet = channel<layout::uint>(2, 1);
    chunk.proxy = channel<T>(3, 3);
    chunk.unshaded = channel<T>(4, 3);
    return chunk;
}

template layout::FieldChunk<float> FieldSlot::results<float>(std::size_t);
template layout::FieldChunk<double> FieldSlot::results<double>(std::size_t);

} // namespace forceshade::compute
