// The field of a case in memory.
#pragma once

#include <cstddef>
#include <vector>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"

namespace forceshade {

/// Every sample of a grid: x fastest, then y, then z. Channels that the case does not ask for are empty.
template <typename T> struct Field {
    std::vector<T> force;    /* N, 3 a sample */
    std::vector<T> depth;    /* m */
    std::vector<T> proxy;    /* m, 3 a sample, from scene_origin() */
    std::vector<T> unshaded; /* N, 3 a sample */
    std::vector<layout::uint> facet;
    EngineTimes times;

    /// The next chunk; where one y stands for all, it stands `repeats` times.
    void append(const layout::FieldChunk<T>& chunk, std::size_t repeats);
};

/// The field of a case's grid, in T whatever the case's own precision. \throws UsageError if a value leaves the range
/// of T, and what Engine::run throws.
template <typename T> Field<T> evaluate(const PreparedCase& prepared, Engine& engine);

/// Of tables that are there already; `repeats` as for append().
template <typename T> Field<T> evaluate(const layout::FieldInput<T>& input, std::size_t repeats, Engine& engine);

} // namespace forceshade
