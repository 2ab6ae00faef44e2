// Exploration paths over analytic surfaces (L1 to L5, L8) on a Vulkan device: batch of paths by batch of paths, within
// one window of steps by window.
#pragma once

#include <functional>
#include <memory>

#include "compute/field_kernel.h"

namespace forceshade::compute {

/// Receives samples, and the metrics of consecutive paths from `first` on when they have ended.
template <typename T> using TakePaths = std::function<void(const layout::PathChunk<T>&)>;
template <typename T>
using TakeMetrics = std::function<void(std::size_t first, std::span<const layout::PathMetrics<T>>)>;

struct PathKernelOptions {
    std::size_t chunk_bytes = std::size_t(32) << 20; /* most for the samples of one dispatch */
    std::size_t batch_paths = 16384;                 /* most paths whose tables are held at once */
    std::uint32_t steps = 0;    /* of a dispatch; 0: as many as end within a second, and no driver breaks off */
    bool force_staging = false; /* copy through a staging buffer even where the host shares the memory */
};

/// Takes paths through their law on one device; keeps pipelines and buffers from one run to the next. Not for two
/// threads at once.
class PathKernel {
public:
    explicit PathKernel(Device& device, const PathKernelOptions& options = {});
    ~PathKernel();

    /// Takes every path of the input (any surface but a mesh) through its law, in T, and hands over chunks while the
    /// device computes the next: batch by batch, within one in the order of steps; then the batch's metrics. `take` is
    /// called only if channels are asked for. Equal to reference<T> bit for bit on a software device. \throws
    /// DeviceError: out_of_memory, device_lost, unfinished (the driver ended a loop early), unsupported (no f64).
    template <typename T>
    FieldTimes explore(const layout::PathInput<T>& input, const TakePaths<T>& take, const TakeMetrics<T>& take_metrics);

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace forceshade::compute
