// The CPU oracle along many paths, on all cores. Also the `--engine cpu` of the command line.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade::reference {

/// Limits of the evaluation.
struct PathOptions {
    unsigned threads = 0;                            /* 0: most_threads() */
    std::size_t chunk_bytes = std::size_t(32) << 20; /* most bytes of samples held at once */
    std::size_t batch_paths = 16384;                 /* most paths whose tables are held at once */
};

/// Receives the metrics of consecutive paths from `first` on, when they have ended.
template <typename T>
using TakeMetrics = std::function<void(std::size_t first, std::span<const layout::PathMetrics<T>>)>;
template <typename T> using TakePaths = std::function<void(const layout::PathChunk<T>&)>;

/// A batch of paths taken through its law some steps at a time. A path depends neither on the others nor on the batch,
/// on how many steps are taken at once or on the number of threads.
template <typename T> class PathWalk {
public:
    virtual ~PathWalk() = default;

    /// Before the first step of the paths from `first` on, at most `count`; how many they are.
    virtual std::size_t begin(std::size_t first, std::size_t count) = 0;
    virtual std::size_t steps() const = 0; /* of the batch's longest path */
    /// The batch's next steps, as many as the options let and at most `most`, at least one. The chunk lives until the
    /// next call.
    virtual layout::PathChunk<T> walk(std::size_t most) = 0;
    /// Of the batch's paths, up to where they are.
    virtual std::vector<layout::PathMetrics<T>> metrics() const = 0;
};

/// `input` and `options` must outlive it.
template <typename T>
std::unique_ptr<PathWalk<T>> make_path_walk(const layout::PathInput<T>& input, const PathOptions& options);

/// Takes every path of the input through its law, in T. Chunks come batch of paths by batch of paths, within one in the
/// order of steps, up to the batch's longest, empty ones where no channel is asked for; then the batch's metrics. Stops
/// early when a callback throws.
template <typename T>
void evaluate_paths(const layout::PathInput<T>& input, const PathOptions& options, const TakePaths<T>& take,
                    const TakeMetrics<T>& take_metrics);

} // namespace forceshade::reference
