// One dispatch of the field kernel in flight: its results and their way to the host. For compute/*.cpp only.
#pragma once

#include <array>
#include <chrono>

#include "compute/field_inputs.h"
#include "compute/field_kernel.h"
#include "compute/field_pipeline.h"

namespace forceshade::compute {

class FieldSlot {
public:
    /// `staged`: results are copied to memory of the host's, else the kernel writes there itself.
    FieldSlot(Device::Implementation& device, const FieldPipelines& pipelines, vk::raii::DescriptorSet set,
              bool staged);

    /// Room for `samples` of each channel, and the kernel's view of it. \throws DeviceError (out_of_memory).
    void reserve(layout::uint channels, std::size_t samples, std::size_t real_size, const FieldInputs& inputs);

    void submit(vk::Pipeline pipeline, const layout::ChunkParams& chunk, std::uint32_t groups);
    bool in_flight() const { return in_flight_; }

    /// Waits for the dispatch and adds its times. \throws DeviceError (device_lost, unfinished).
    void finish(FieldTimes& times);

    /// The results of the finished dispatch; they live until the next one.
    template <typename T> layout::FieldChunk<T> results(std::size_t x_count);

private:
    static constexpr std::size_t kChannelCount = 5;

    void record(vk::Pipeline pipeline, std::uint32_t groups);
    void add_times(FieldTimes& times);
    std::size_t samples() const { return std::size_t(chunk_.y_count) * chunk_.z_count * chunk_.x_pitch; }
    template <typename Value> std::span<const Value> channel(std::size_t which, std::size_t values_a_sample);

    Device::Implementation& device_;
    const FieldPipelines& pipelines_;
    bool staged_;
    std::array<Buffer, kChannelCount> results_, staging_;
    Buffer status_;
    vk::raii::DescriptorSet set_;
    vk::raii::CommandBuffer commands_;
    vk::raii::Fence fence_;
    vk::raii::QueryPool timestamps_{nullptr};
    std::chrono::steady_clock::time_point submitted_;
    layout::ChunkParams chunk_{};
    layout::uint channels_ = 0;
    std::size_t real_size_ = 0;
    bool in_flight_ = false;
};

} // namespace forceshade::compute
