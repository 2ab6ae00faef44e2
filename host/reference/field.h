// The CPU oracle over a grid: the reference law at every sample, on all cores. Also the `--engine cpu` of the command
// line.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <vector>

#include "host/reference/chunks.h"
#include "shaders/shared/law.h"

namespace forceshade::reference {

/// What the evaluation may use.
struct FieldOptions {
    unsigned threads = 0;                            /* 0: most_threads() */
    std::size_t chunk_bytes = std::size_t(32) << 20; /* most bytes of results held at once */
};

/// Evaluates the law at every sample of the grid, in T, and hands over consecutive chunks of rows in order (z, then y).
/// The channels are those of `input.law.features`. Stops early when `consume` throws.
template <typename T>
void evaluate_field(const layout::FieldInput<T>& input, const FieldOptions& options,
                    const std::function<void(const layout::FieldChunk<T>&)>& consume);

/// The plan of a mesh's samples z in [z_first, z_first + z_count), z_first even; valid until it is asked for the next.
using PlanLayers = std::function<layout::MeshPlan(std::size_t z_first, std::size_t z_count)>;

/// L6 static, as evaluate_field() with the same bits: voxels outside of the plan are out of contact, and only a block's
/// candidates are tested.
template <typename T>
void evaluate_mesh_field(const layout::FieldInput<T>& input, const FieldOptions& options, const PlanLayers& plan,
                         const std::function<void(const layout::FieldChunk<T>&)>& consume);

// The CPU oracle along many paths, on all cores. Also the `--engine cpu` of the command line.

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

// Forces over an analytic surface, a row of samples along x at a time: the operations of contact_at in its order, so
// the same bits, on as many samples at once as the processor can.

/// Per-column data, constant in z: 3 numbers a sample, as in the result, or 1.
template <typename T> struct ForceColumns {
    const T *height, *normal, *direction, *texture;     /* 3: m, 1, 1, 1 */
    const T* sideways;                                  /* 3: 1 where a texture may push, else 0 */
    const T *x, *on_bump, *facet_height, *facet_normal; /* 1: m, 0 or 1, m, 1 */
    std::size_t samples;
};

template <typename T> class ForceRows {
public:
    /// True where rows serve: an analytic surface, and no channel but the force is asked for.
    static bool serve(const layout::Features& features) {
        return features.surface != layout::kSurfaceMesh && features.channels == layout::kChannelForce;
    }
    /// Bytes that the columns of a grid take.
    static std::size_t bytes(const layout::FieldInput<T>& input, std::size_t rows);

    /// The columns above input.x and rows of input.y from `first` on.
    void prepare(const layout::FieldInput<T>& input, std::size_t first, std::size_t rows, Crew& crew);
    /// N: 3 numbers a sample of a row of input.y, at height z, m.
    void evaluate(const layout::Law<T>& law, std::size_t y, T z, T* force) const;

private:
    std::vector<T> height_, normal_, sideways_, x_, on_bump_, facet_height_, facet_normal_; // of any row
    std::vector<T> direction_, texture_;                                                    // row by row, or of any row
    std::size_t first_ = 0;
    bool alike_ = true; // all rows are
};

} // namespace forceshade::reference
