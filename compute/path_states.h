// The paths' states between dispatches, on the device; their metrics on the way to the host. For compute/*.cpp only.
#pragma once

#include "compute/input_buffers.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

class PathStates {
public:
    /// `staged`: read through a buffer of the host's.
    PathStates(Device::Implementation& device, bool staged);

    /// Room for the states of so many paths. \throws DeviceError (out_of_memory).
    void reserve(std::size_t paths, std::size_t state_bytes);
    vk::Buffer buffer() const { return *states_.buffer; }

    /// The metrics of the batch, when all dispatches are done; they live until the next call.
    template <typename T> std::span<const layout::PathMetrics<T>> metrics(std::size_t paths);

private:
    template <typename T> std::vector<layout::PathMetrics<T>>& read();

    Device::Implementation& device_;
    bool staged_;
    Buffer states_, staging_;
    vk::raii::CommandBuffer commands_;
    vk::raii::Fence fence_;
    std::vector<layout::PathMetrics<float>> metrics_f32_;
    std::vector<layout::PathMetrics<double>> metrics_f64_;
};

} // namespace forceshade::compute
