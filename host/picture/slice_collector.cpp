#include "host/picture/slice_collector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forceshade::picture {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

std::vector<double> coordinates(const GridSpec& grid, std::size_t axis, const std::vector<std::uint64_t>& indices) {
    std::vector<double> result(indices.size());
    std::transform(indices.begin(), indices.end(), result.begin(),
                   [&](std::uint64_t i) { return grid.origin[axis] + grid.spacing[axis] * static_cast<double>(i); });
    return result;
}

// The part of `wanted`, as positions [first, last), that lies in [begin, begin + count).
struct Positions {
    std::size_t first, last;
};
Positions positions_within(const std::vector<std::uint64_t>& wanted, std::uint64_t begin, std::uint64_t count) {
    const auto first = std::lower_bound(wanted.begin(), wanted.end(), begin);
    const auto last = std::lower_bound(first, wanted.end(), begin + count);
    return {static_cast<std::size_t>(first - wanted.begin()), static_cast<std::size_t>(last - wanted.begin())};
}

template <typename real>
std::array<double, 3> force_at(const layout::FieldChunk<real>& chunk, std::span<const real> channel, std::uint64_t x,
                               std::uint64_t y, std::uint64_t z) {
    const std::size_t row = (z - chunk.z_first) * chunk.y_count + (y - chunk.y_first);
    const real* force = channel.data() + 3 * (row * chunk.x_pitch + x);
    return {static_cast<double>(force[0]), static_cast<double>(force[1]), static_cast<double>(force[2])};
}

// The library's hypot of three says 0 for (0, 0, NaN), which would pass as free space.
double length(const std::array<double, 3>& f) {
    const bool finite = std::isfinite(f[0]) && std::isfinite(f[1]) && std::isfinite(f[2]);
    return finite ? std::hypot(f[0], f[1], f[2]) : kMissing;
}

} // namespace

MagnitudeSlice magnitude_of(const FieldSlice& slice) {
    MagnitudeSlice result{slice.axes, std::vector<double>(slice.force.size())};
    std::transform(slice.force.begin(), slice.force.end(), result.magnitude.begin(), length);
    return result;
}

std::vector<std::uint64_t> even_indices(std::uint64_t count, std::size_t wanted) {
    std::vector<std::uint64_t> result(static_cast<std::size_t>(std::min<std::uint64_t>(count, wanted)));
    if (result.size() < 2) // a single one: the first of one, there is no "last" to include
        return result;
    const std::uint64_t steps = result.size() - 1;
    const std::uint64_t whole = (count - 1) / steps;
    const std::uint64_t rest = (count - 1) % steps;
    for (std::uint64_t i = 0; i <= steps; ++i) // i (count - 1) / steps, rounded, without overflow
        result[i] = i * whole + (i * rest + steps / 2) / steps;
    return result;
}

SliceCollector::SliceCollector(const GridSpec& grid, bool repeat_y)
    : repeat_y_(repeat_y), middle_y_((std::max<std::uint64_t>(grid.size[1], 1) - 1) / 2),
      columns_(even_indices(grid.size[0], kMaxSliceSamples)), rows_(even_indices(grid.size[1], kMaxSliceSamples)),
      levels_(even_indices(grid.size[2], kMaxSliceSamples)), tile_at_(even_indices(grid.size[2], kMaxTiles)) {
    xz_.axes = {coordinates(grid, 0, columns_),
                coordinates(grid, 2, levels_),
                grid.spacing[0],
                grid.spacing[2],
                grid.spacing[1],
                coordinates(grid, 1, {middle_y_})[0]};
    unshaded_xz_.axes = xz_.axes;
    xz_.force.assign(columns_.size() * levels_.size(), {kMissing, kMissing, kMissing});
    const std::vector<double> heights = coordinates(grid, 2, tile_at_);
    for (const double z : heights) {
        tiles_.push_back(
            {{xz_.axes.u, coordinates(grid, 1, rows_), grid.spacing[0], grid.spacing[1], grid.spacing[2], z},
             std::vector<double>(columns_.size() * rows_.size(), kMissing)});
    }
}

void SliceCollector::add(const layout::FieldChunk<float>& chunk) {
    add_chunk(chunk);
}
void SliceCollector::add(const layout::FieldChunk<double>& chunk) {
    add_chunk(chunk);
}

template <typename real> void SliceCollector::add_chunk(const layout::FieldChunk<real>& chunk) {
    const bool has_middle = repeat_y_ || (middle_y_ >= chunk.y_first && middle_y_ - chunk.y_first < chunk.y_count);
    if (has_middle)
        keep_xz(chunk);
    const Positions tiles = positions_within(tile_at_, chunk.z_first, chunk.z_count);
    for (std::size_t tile = tiles.first; tile < tiles.last; ++tile)
        keep_tile(chunk, tile);
}

template <typename real> void SliceCollector::keep_xz(const layout::FieldChunk<real>& chunk) {
    const std::uint64_t y = repeat_y_ ? chunk.y_first : middle_y_;
    const Positions levels = positions_within(levels_, chunk.z_first, chunk.z_count);
    if (!chunk.unshaded.empty() && unshaded_xz_.force.empty())
        unshaded_xz_.force.assign(xz_.force.size(), {kMissing, kMissing, kMissing});
    for (std::size_t level = levels.first; level < levels.last; ++level)
        for (std::size_t column = 0; column < columns_.size(); ++column) {
            const std::size_t sample = level * columns_.size() + column;
            xz_.force[sample] = force_at(chunk, chunk.force, columns_[column], y, levels_[level]);
            if (!chunk.unshaded.empty())
                unshaded_xz_.force[sample] = force_at(chunk, chunk.unshaded, columns_[column], y, levels_[level]);
        }
}

template <typename real> void SliceCollector::keep_tile(const layout::FieldChunk<real>& chunk, std::size_t tile) {
    const Positions rows =
        repeat_y_ ? Positions{0, rows_.size()} : positions_within(rows_, chunk.y_first, chunk.y_count);
    std::vector<double>& magnitude = tiles_[tile].magnitude;
    for (std::size_t row = rows.first; row < rows.last; ++row) {
        const std::uint64_t y = repeat_y_ ? chunk.y_first : rows_[row];
        for (std::size_t column = 0; column < columns_.size(); ++column)
            magnitude[row * columns_.size() + column] =
                length(force_at(chunk, chunk.force, columns_[column], y, tile_at_[tile]));
    }
}

} // namespace forceshade::picture
