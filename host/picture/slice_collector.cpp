#include "host/picture/slice_collector.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forceshade::picture {
namespace {

constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();

// The sample nearest to `at` along an axis; the middle one, rounded down, if `at` is empty.
std::uint64_t chosen_index(const GridSpec& grid, std::size_t axis, std::optional<double> at) {
    const std::uint64_t last = std::max<std::uint64_t>(grid.size[axis], 1) - 1;
    if (!at)
        return last / 2;
    const double index = std::round((*at - grid.origin[axis]) / grid.spacing[axis]);
    return static_cast<std::uint64_t>(std::clamp(index, 0.0, static_cast<double>(last)));
}

} // namespace

std::vector<std::uint64_t> even_indices(std::uint64_t count, std::size_t wanted) {
    std::vector<std::uint64_t> result(static_cast<std::size_t>(std::min<std::uint64_t>(count, wanted)));
    if (result.size() < 2) // a single one: the first
        return result;
    const std::uint64_t steps = result.size() - 1;
    const std::uint64_t whole = (count - 1) / steps;
    const std::uint64_t rest = (count - 1) % steps;
    for (std::uint64_t i = 0; i <= steps; ++i) // i (count - 1) / steps, rounded, without overflow
        result[i] = i * whole + (i * rest + steps / 2) / steps;
    return result;
}

SliceCollector::SliceCollector(const GridSpec& grid, bool repeat_y, const SliceChoice& choice)
    : grid_(grid), repeat_y_(repeat_y), choice_(choice),
      plane_(plane(choice.axis, chosen_index(grid, choice.axis, choice.at))) {
    slice_.axes = unshaded_.axes = axes_of(plane_);
    slice_.force.assign(plane_.u.size() * plane_.v.size(), {kMissing, kMissing, kMissing});
    for (const std::uint64_t z : even_indices(grid.size[2], kMaxTiles)) {
        const Plane& tile = tile_planes_.emplace_back(plane(2, z));
        tiles_.push_back({axes_of(tile), std::vector<double>(tile.u.size() * tile.v.size(), kMissing)});
    }
}

SliceCollector::Plane SliceCollector::plane(std::size_t normal, std::uint64_t at) const {
    const std::size_t u = normal == 0 ? 1 : 0, v = normal == 2 ? 1 : 2;
    return {{u, v, normal},
            even_indices(grid_.size[u], kMaxSliceSamples),
            even_indices(grid_.size[v], kMaxSliceSamples),
            at};
}

SliceAxes SliceCollector::axes_of(const Plane& plane) const {
    const auto [u, v, normal] = plane.axis;
    const auto coordinates = [&](std::size_t axis, const std::vector<std::uint64_t>& indices) {
        std::vector<double> result;
        for (const std::uint64_t i : indices)
            result.push_back(grid_.origin[axis] + grid_.spacing[axis] * static_cast<double>(i));
        return result;
    };
    return {coordinates(u, plane.u),
            coordinates(v, plane.v),
            grid_.spacing[u],
            grid_.spacing[v],
            grid_.spacing[normal],
            coordinates(normal, {plane.at})[0],
            plane.axis};
}

// Calls keep(number of the sample in the plane, its place in a channel of the chunk) for all that the chunk has.
template <typename real, typename Keep>
void SliceCollector::visit(const layout::FieldChunk<real>& chunk, const Plane& plane, const Keep& keep) const {
    const auto has_y = [&](std::uint64_t y) {
        return repeat_y_ || (y >= chunk.y_first && y - chunk.y_first < chunk.y_count);
    };
    const auto has_z = [&](std::uint64_t z) { return z >= chunk.z_first && z - chunk.z_first < chunk.z_count; };
    std::array<std::uint64_t, 3> at{};
    at[plane.axis[2]] = plane.at;
    for (std::size_t v = 0; v < plane.v.size(); ++v) {
        at[plane.axis[1]] = plane.v[v];
        if (!has_z(at[2]))
            continue;
        for (std::size_t u = 0; u < plane.u.size(); ++u) {
            at[plane.axis[0]] = plane.u[u];
            if (!has_y(at[1]))
                continue;
            const std::size_t row = (at[2] - chunk.z_first) * chunk.y_count + (repeat_y_ ? 0 : at[1] - chunk.y_first);
            keep(v * plane.u.size() + u, 3 * (row * chunk.x_pitch + at[0]));
        }
    }
}

template <typename real> void SliceCollector::add(const layout::FieldChunk<real>& chunk) {
    using Force = std::array<double, 3>;
    const auto force_at = [](std::span<const real> channel, std::size_t i) {
        return channel.empty() ? Force{} : Force{double(channel[i]), double(channel[i + 1]), double(channel[i + 2])};
    };
    if (!chunk.unshaded.empty() && unshaded_.force.empty())
        unshaded_.force.assign(slice_.force.size(), {kMissing, kMissing, kMissing});
    visit(chunk, plane_, [&](std::size_t sample, std::size_t place) {
        slice_.force[sample] = force_at(chunk.force, place);
        if (!chunk.unshaded.empty())
            unshaded_.force[sample] = force_at(chunk.unshaded, place);
    });
    for (std::size_t tile = 0; tile < tiles_.size(); ++tile)
        visit(chunk, tile_planes_[tile], [&](std::size_t sample, std::size_t place) {
            tiles_[tile].value[sample] = value_of(choice_.quantity, force_at(chunk.force, place),
                                                  force_at(chunk.unshaded, place), tile_planes_[tile].axis);
        });
}

template void SliceCollector::add(const layout::FieldChunk<float>&);
template void SliceCollector::add(const layout::FieldChunk<double>&);

} // namespace forceshade::picture
