#include "compute/path_states.h"

#include <cstring>
#include <type_traits>

namespace forceshade::compute {

PathStates::PathStates(Device::Implementation& device, bool staged)
    : device_(device), staged_(staged), commands_(make_commands(device)), fence_(device.device.createFence({})) {}

void PathStates::reserve(std::size_t paths, std::size_t state_bytes) {
    using Usage = vk::BufferUsageFlagBits;
    grow(device_, states_, paths * state_bytes, Usage::eStorageBuffer | Usage::eTransferSrc,
         staged_ ? Placement::device : Placement::host_read);
    if (staged_)
        grow(device_, staging_, paths * state_bytes, Usage::eTransferDst, Placement::host_read);
}

template <typename T> std::vector<layout::PathMetrics<T>>& PathStates::read() {
    if constexpr (std::is_same_v<T, double>)
        return metrics_f64_;
    else
        return metrics_f32_;
}

template <typename T> std::span<const layout::PathMetrics<T>> PathStates::metrics(std::size_t paths) {
    using Stage = vk::PipelineStageFlagBits;
    using Access = vk::AccessFlagBits;
    const std::size_t bytes = paths * sizeof(layout::PathState<T>);
    if (staged_) {
        commands_.reset();
        commands_.begin({vk::CommandBufferUsageFlagBits::eOneTimeSubmit});
        const vk::MemoryBarrier computed(Access::eShaderWrite, Access::eTransferRead);
        commands_.pipelineBarrier(Stage::eComputeShader, Stage::eTransfer, {}, computed, {}, {});
        commands_.copyBuffer(*states_.buffer, *staging_.buffer, vk::BufferCopy(0, 0, bytes));
        const vk::MemoryBarrier copied(Access::eTransferWrite, Access::eHostRead);
        commands_.pipelineBarrier(Stage::eTransfer, Stage::eHost, {}, copied, {}, {});
        commands_.end();
        device_.device.resetFences(*fence_);
        device_.queue.submit(vk::SubmitInfo({}, {}, *commands_), *fence_);
        wait_for(device_, fence_);
    }
    const std::byte* const from = visible_to_host(device_, staged_ ? staging_ : states_);
    std::vector<layout::PathMetrics<T>>& metrics = read<T>();
    metrics.resize(paths);
    for (std::size_t path = 0; path < paths; ++path)
        std::memcpy(&metrics[path],
                    from + path * sizeof(layout::PathState<T>) + offsetof(layout::PathState<T>, metrics),
                    sizeof(metrics[path]));
    return metrics;
}

template std::span<const layout::PathMetrics<float>> PathStates::metrics<float>(std::size_t);
template std::span<const layout::PathMetrics<double>> PathStates::metrics<double>(std::size_t);

} // namespace forceshade::compute
