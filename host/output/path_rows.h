// Paths as rows, and where they go: a file that receives them in order and is published when complete.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <span>
#include <vector>

#include "host/output/rows.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Consecutive paths, complete, or some steps of one path. Sample (path, step) stands at path * pitch + step -
/// step_first. Channels that were not asked for are empty.
template <typename T> struct PathRows {
    std::size_t path_first = 0, path_count = 0;
    std::size_t pitch = 0;               // samples of a row
    std::span<const layout::uint> steps; // of each path, in all; what follows in its row means nothing
    std::span<const T> position;         // m, 3 a sample
    std::span<const T> force;            // N, 3 a sample
    std::span<const T> depth;            // m
    std::span<const layout::uint> facet; // id
    std::span<const T> proxy;            // m, 3 a sample
    std::size_t step_first = 0;          // of the rows

    /// How many samples of a path stand here.
    std::size_t samples(std::size_t path) const {
        return std::min(pitch, std::max<std::size_t>(steps[path], step_first) - step_first);
    }
    /// True if a path has no samples after these.
    bool ends(std::size_t path) const { return step_first + pitch >= steps[path]; }
};

/// The reals of a channel that is not the facet id. Throws std::logic_error if the rows lack it.
template <typename T> std::span<const T> values_of(const PathRows<T>& rows, std::uint32_t channel);

/// Paths arrive in order, steps of one in order. A sink that is destroyed before finish() leaves no file.
class PathSink {
public:
    virtual ~PathSink() = default;
    /// Throws IoError; std::logic_error if paths come out of order or a channel is missing.
    virtual void write(const PathRows<float>& rows) = 0;
    virtual void write(const PathRows<double>& rows) = 0;
    /// After the last path, once. Throws IoError.
    virtual VolumeResult finish() = 0;
};

// Engines hand over steps of many paths at a time; files want path after path. A batch of paths is held in between, but
// a batch of one path goes on as it comes.

/// Most bytes of rows that are held at once.
inline constexpr std::size_t kRowBytes = std::size_t(64) << 20;
/// Most samples of a batch whose metrics alone are asked for: an interrupt is noticed between two batches.
inline constexpr std::size_t kMetricSamples = std::size_t(1) << 24;
/// Likewise on a mesh, where a sample takes longer.
inline constexpr std::size_t kMeshMetricSamples = std::size_t(1) << 22;

/// Bytes of a sample of so many channels.
std::size_t path_sample_bytes(layout::uint channels, std::size_t real_bytes);

/// The samples of a batch whose rows fit into kRowBytes, or whose metrics come soon enough.
template <typename T> std::size_t samples_that_fit(const layout::PathInput<T>& input);
/// The paths of such a batch, at least 1. Of recorded paths, whose lengths differ, their source knows better how many.
template <typename T> std::size_t paths_that_fit(const layout::PathInput<T>& input);

/// Gives an engine fewer paths at a time than it asks for, tells it how long the longest of them is, and remembers of
/// them what metrics do not say.
template <typename T> class BatchedSource final : public layout::PathSource<T> {
public:
    /// `steps` of the longest path. `paths` must outlive this.
    BatchedSource(layout::PathSource<T>& paths, std::size_t steps, std::size_t most)
        : paths_(paths), steps_(steps), most_(most) {}

    layout::PathBatch<T> batch(std::size_t first, std::size_t count) override;
    std::span<const T> positions(std::size_t step, std::size_t steps) override { return paths_.positions(step, steps); }

    /// Of the present batch: the samples of each path and of the longest, and whether a path began behind the surface
    /// (empty without a mesh).
    std::span<const layout::uint> lengths() const { return lengths_; }
    std::size_t longest() const { return longest_; }
    const std::vector<bool>& inside() const { return inside_; }

private:
    layout::PathSource<T>& paths_;
    std::size_t steps_, most_, longest_ = 0;
    std::vector<layout::uint> lengths_;
    std::vector<bool> inside_;
};

template <typename T> class RowGatherer {
public:
    using Take = std::function<void(const PathRows<T>&)>;
    /// `take` receives every batch of paths when its last step has come, of a batch of one path every chunk. `source`
    /// gives the chunks' batches.
    RowGatherer(const BatchedSource<T>& source, Take take);

    /// The next steps of a batch. \throws std::logic_error if they come out of order.
    void add(const layout::PathChunk<T>& chunk);

private:
    struct Buffer {
        std::vector<T> position, force, depth, proxy;
        std::vector<layout::uint> facet;
    };

    const BatchedSource<T>& source_;
    Take take_;
    std::size_t next_step_ = 0;
    Buffer rows_;
};

extern template class BatchedSource<float>;
extern template class BatchedSource<double>;
extern template class RowGatherer<float>;
extern template class RowGatherer<double>;

} // namespace forceshade
