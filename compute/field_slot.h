// One dispatch of a field's kernel in flight: its results and their way to the host. For compute/*.cpp only.
#pragma once

#include <array>
#include <chrono>
#include <functional>

#include "compute/field_kernel.h"
#include "compute/input_buffers.h"

namespace forceshade::compute {

/// Where a kernel of fields binds its status word and its results: force, depth, facet, proxy, unshaded.
struct SlotBindings {
    layout::uint count = 0; /* of all bindings */
    layout::uint status = 0;
    std::array<layout::uint, 5> results{};
};

/// The rows of one dispatch, and samples of a row as stored.
struct ChunkShape {
    std::uint32_t x_pitch = 0, y_first = 0, y_count = 0, z_first = 0, z_count = 0;
};

class FieldSlot {
public:
    static constexpr std::size_t kChannelCount = 5;

    /// `staged`: results are copied to memory of the host's, else the kernel writes there itself.
    FieldSlot(Device::Implementation& device, const SlotBindings& bindings, vk::raii::DescriptorSet set, bool staged);

    /// Room for `samples` of each channel, and the kernel's view of it; `inputs` gives the buffers of all other
    /// bindings. \throws DeviceError (out_of_memory).
    void reserve(layout::uint channels, std::size_t samples, std::size_t real_size,
                 const std::function<vk::Buffer(layout::uint)>& inputs);

    /// `work` records the dispatches, after which results lie in the buffers of the channels.
    void submit(const ChunkShape& chunk, const std::function<void(const vk::raii::CommandBuffer&)>& work);
    bool in_flight() const { return in_flight_; }

    /// Waits for the dispatch and adds its times. \throws DeviceError (device_lost, unfinished).
    void finish(FieldTimes& times);

    /// The results of the finished dispatch; they live until the next one.
    template <typename T> layout::FieldChunk<T> results(std::size_t x_count);

    bool staged() const { return staged_; }
    vk::DescriptorSet set() const { return *set_; }
    /// The buffer of a channel, in the order of SlotBindings::results, and the bytes that the chunk takes of it; none
    /// if the features lack it.
    struct Result {
        vk::Buffer buffer;
        std::size_t bytes = 0;
    };
    Result result(std::size_t channel) const;

private:
    void record(const std::function<void(const vk::raii::CommandBuffer&)>& work);
    void add_times(FieldTimes& times);
    std::size_t samples() const { return std::size_t(chunk_.y_count) * chunk_.z_count * chunk_.x_pitch; }
    template <typename Value> std::span<const Value> channel(std::size_t which, std::size_t values_a_sample);

    Device::Implementation& device_;
    SlotBindings bindings_;
    bool staged_;
    std::array<Buffer, kChannelCount> results_, staging_;
    Buffer status_;
    vk::raii::DescriptorSet set_;
    vk::raii::CommandBuffer commands_;
    vk::raii::Fence fence_;
    vk::raii::QueryPool timestamps_{nullptr};
    std::chrono::steady_clock::time_point submitted_;
    ChunkShape chunk_;
    layout::uint channels_ = 0;
    std::size_t real_size_ = 0;
    bool in_flight_ = false;
};

} // namespace forceshade::compute
