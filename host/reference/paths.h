// The CPU oracle along many paths, on all cores. Also the `--engine cpu` of the command line.
#pragma once

#include <functional>

#include "shaders/shared/layout.h"

namespace forceshade::reference {

/// What the evaluation may use.
struct PathOptions {
    unsigned threads = 0;                            /* 0: as many as the machine has cores */
    std::size_t chunk_bytes = std::size_t(32) << 20; /* most bytes of samples held at once */
    std::size_t batch_paths = 16384;                 /* most paths whose tables are held at once */
};

/// Receives the metrics of consecutive paths from `first` on, when they have ended.
template <typename T>
using TakeMetrics = std::function<void(std::size_t first, std::span<const layout::PathMetrics<T>>)>;
template <typename T> using TakePaths = std::function<void(const layout::PathChunk<T>&)>;

/// Takes every path of the input through its law, in T. Chunks come batch of paths by batch of paths, within one in the
/// order of steps, empty ones where no channel is asked for; then the batch's metrics. Nothing of a path depends on the
/// others, on the batch or on the number of threads. Stops early when a callback throws.
template <typename T>
void evaluate_paths(const layout::PathInput<T>& input, const PathOptions& options, const TakePaths<T>& take,
                    const TakeMetrics<T>& take_metrics);

extern template void evaluate_paths<float>(const layout::PathInput<float>&, const PathOptions&, const TakePaths<float>&,
                                           const TakeMetrics<float>&);
extern template void evaluate_paths<double>(const layout::PathInput<double>&, const PathOptions&,
                                            const TakePaths<double>&, const TakeMetrics<double>&);

} // namespace forceshade::reference
