// Whether work that was computed twice came out the same: a number of 64 bits for each row of a field, or each path.
#pragma once

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade {

class Digests {
public:
    explicit Digests(std::size_t rows) : rows_(rows, 0) {}

    /// Further values of a row, in their order.
    template <typename Value> void add(std::size_t row, std::span<const Value> values) {
        std::uint64_t digest = rows_[row];
        for (const Value& value : values) {
            std::uint64_t bits = 0;
            std::memcpy(&bits, &value, sizeof(Value));
            digest = (std::rotl(digest, 29) ^ bits) * 0x9E3779B97F4A7C15u;
        }
        rows_[row] = digest;
    }

    /// The rows' number if there is none.
    std::size_t first_difference(const Digests& other) const {
        return static_cast<std::size_t>(std::ranges::mismatch(rows_, other.rows_).in1 - rows_.begin());
    }

private:
    std::vector<std::uint64_t> rows_;
};

/// A field's row is z * ny + y.
template <typename T> void add(Digests& digests, const layout::FieldChunk<T>& chunk, std::size_t ny) {
    const auto add_row = [&]<typename Value>(std::size_t row, std::size_t at, std::span<const Value> values,
                                             std::size_t width) {
        if (!values.empty())
            digests.add(row, values.subspan(width * at, width * chunk.x_count));
    };
    for (std::size_t z = 0; z < chunk.z_count; ++z)
        for (std::size_t y = 0; y < chunk.y_count; ++y) {
            const std::size_t row = (chunk.z_first + z) * ny + chunk.y_first + y;
            const std::size_t at = (z * chunk.y_count + y) * chunk.x_pitch;
            add_row(row, at, chunk.force, 3);
            add_row(row, at, chunk.depth, 1);
            add_row(row, at, chunk.facet, 1);
            add_row(row, at, chunk.proxy, 3);
            add_row(row, at, chunk.unshaded, 3);
        }
}

/// Some steps of some paths; `lengths` of all paths, behind whose ends may stand anything.
template <typename T>
void add(Digests& digests, const layout::PathChunk<T>& chunk, std::span<const layout::uint> lengths) {
    const auto add_sample = [&]<typename Value>(std::size_t path, std::size_t at, std::span<const Value> values,
                                                std::size_t width) {
        if (!values.empty())
            digests.add(path, values.subspan(width * at, width));
    };
    for (std::size_t i = 0; i < chunk.path_count; ++i) {
        const std::size_t path = chunk.path_first + i;
        const std::size_t end = std::min<std::size_t>(chunk.step_first + chunk.step_count, lengths[path]);
        for (std::size_t step = chunk.step_first; step < end; ++step) {
            const std::size_t at = (step - chunk.step_first) * chunk.pitch + i;
            add_sample(path, at, chunk.position, 3);
            add_sample(path, at, chunk.force, 3);
            add_sample(path, at, chunk.depth, 1);
            add_sample(path, at, chunk.facet, 1);
            add_sample(path, at, chunk.proxy, 3);
        }
    }
}

/// Metrics have no padding, so that their bytes are theirs alone.
template <typename T> void add(Digests& digests, std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
    for (std::size_t i = 0; i < metrics.size(); ++i)
        digests.add(first + i, std::span(reinterpret_cast<const layout::uint*>(&metrics[i]),
                                         sizeof(metrics[i]) / sizeof(layout::uint)));
}

} // namespace forceshade
