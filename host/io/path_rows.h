// Paths as rows, and where they go: a file that receives them in order and is published when complete.
#pragma once

#include <algorithm>
#include <cstddef>
#include <span>

#include "host/io/chunk_sink.h"
#include "shaders/shared/layout.h"

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

} // namespace forceshade
