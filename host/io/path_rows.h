// Complete paths as rows, and where they go: a file that receives them in order and is published when complete.
#pragma once

#include <cstddef>
#include <span>

#include "host/io/chunk_sink.h"
#include "shaders/shared/layout.h"

namespace forceshade {

/// Consecutive paths: sample (path, step) stands at path * pitch + step. Channels that were not asked for are empty.
template <typename T> struct PathRows {
    std::size_t path_first = 0, path_count = 0;
    std::size_t pitch = 0;               // samples of a row
    std::span<const layout::uint> steps; // of each path; what follows in its row means nothing
    std::span<const T> position;         // m, 3 a sample
    std::span<const T> force;            // N, 3 a sample
    std::span<const T> depth;            // m
    std::span<const layout::uint> facet; // id
    std::span<const T> proxy;            // m, 3 a sample
};

/// The reals of a channel that is not the facet id. Throws std::logic_error if the rows lack it.
template <typename T> std::span<const T> values_of(const PathRows<T>& rows, std::uint32_t channel);

/// Paths arrive in order. A sink that is destroyed before finish() leaves no file.
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
