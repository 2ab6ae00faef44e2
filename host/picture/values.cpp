#include "host/picture/values.h"

#include <algorithm>
#include <map>
#include <numbers>
#include <numeric>
#include <set>

#include <fmt/format.h>

#include "host/picture/frame.h"

namespace forceshade::picture {
namespace {

constexpr double kDegreesInTurn = 180 / std::numbers::pi;

using Force = std::array<double, 3>;

double length(const Force& f) {
    return std::hypot(f[0], f[1], f[2]);
}

// Between two vectors of those lengths (Kahan 2006, "How futile are mindless assessments of roundoff", section 12).
double angle_between(const Force& a, double a_length, const Force& b, double b_length) {
    Force sum{}, difference{};
    for (std::size_t i = 0; i < 3; ++i) {
        sum[i] = a[i] / a_length + b[i] / b_length;
        difference[i] = a[i] / a_length - b[i] / b_length;
    }
    return 2 * kDegreesInTurn * std::atan2(length(difference), length(sum));
}

template <typename T> std::vector<T> cut(const std::vector<T>& all, std::size_t width, const Window& window) {
    std::vector<T> part;
    for (std::size_t v = window.v_first; !all.empty() && v <= window.v_last; ++v)
        for (std::size_t u = window.u_first; u <= window.u_last; ++u)
            part.push_back(all[v * width + u]);
    return part;
}

SliceAxes cut(SliceAxes axes, const Window& window) {
    axes.u = cut(axes.u, axes.u.size(), {window.u_first, window.u_last, 0, 0});
    axes.v = cut(axes.v, axes.v.size(), {window.v_first, window.v_last, 0, 0});
    return axes;
}

} // namespace

double value_of(Quantity quantity, const Force& force, const Force& unshaded, const std::array<std::size_t, 3>& axis) {
    const double size = length(force);
    if (size == 0)
        return kNoForce;
    switch (quantity) {
    case Quantity::magnitude:
        return size;
    case Quantity::direction:
        return kDegreesInTurn * std::atan2(force[axis[0]], force[axis[1]]);
    case Quantity::angle: {
        const double other = length(unshaded);
        return other == 0 ? kNoForce : angle_between(force, size, unshaded, other);
    }
    default:
        return force[static_cast<std::size_t>(quantity) - static_cast<std::size_t>(Quantity::x)];
    }
}

ValueSlice values_of(const FieldSlice& slice, Quantity quantity, const FieldSlice& unshaded) {
    ValueSlice result{slice.axes, std::vector<double>(slice.force.size())};
    for (std::size_t i = 0; i < slice.force.size(); ++i)
        result.value[i] =
            value_of(quantity, slice.force[i], unshaded.force.empty() ? Force{} : unshaded.force[i], slice.axes.axis);
    return result;
}

double largest_of(const ValueSlice& slice) {
    double largest = 0;
    for (const double value : slice.value)
        if (value != kNoForce)
            largest = std::max(largest, std::fabs(value));
    return largest;
}

// Marching squares. Edge 2 i lies between sample i and the next one along u, edge 2 i + 1 along v.
std::vector<std::vector<ContourPoint>> contours(const FieldSlice& slice, double force) {
    const std::vector<double>&u = slice.axes.u, &v = slice.axes.v;
    const std::size_t columns = u.size();
    std::vector<double> size;
    for (const Force& one : slice.force)
        size.push_back(length(one));
    std::map<std::size_t, std::size_t> next; // each edge that a line crosses has one line into it, and one out of it
    std::set<std::size_t> reached;
    for (std::size_t cell = 0; cell + columns + 1 < size.size(); ++cell) {
        if (cell % columns + 1 == columns)
            continue;
        const std::array corner{cell, cell + 1, cell + columns + 1, cell + columns};
        const std::array edge{2 * cell, 2 * (cell + 1) + 1, 2 * (cell + columns), 2 * cell + 1};
        const auto within = [&](std::size_t i) { return size[corner[i % 4]] >= force; };
        for (std::size_t first = 0; first < 4; ++first)
            if (!within(first) && within(first + 1)) { // around the corners within, up to the next one without
                std::size_t last = first + 1;
                while (within(last + 1))
                    ++last;
                next[edge[first]] = edge[last % 4];
                reached.insert(edge[last % 4]);
            }
    }
    const auto point = [&](std::size_t edge) -> ContourPoint {
        std::size_t inside = edge / 2, outside = inside + (edge % 2 == 0 ? 1 : columns);
        if (size[inside] < force)
            std::swap(inside, outside);
        const double share = (force - size[outside]) / (size[inside] - size[outside]);
        const auto between = [&](const std::vector<double>& at, std::size_t from, std::size_t to) {
            return std::lerp(at[from] - at[0], at[to] - at[0], share);
        };
        return {between(u, outside % columns, inside % columns), between(v, outside / columns, inside / columns),
                inside};
    };
    std::vector<std::vector<ContourPoint>> lines;
    const auto follow = [&](std::size_t edge) {
        std::vector<ContourPoint>& line = lines.emplace_back(1, point(edge));
        for (auto at = next.find(edge); at != next.end(); at = next.find(edge)) {
            edge = at->second;
            line.push_back(point(edge));
            next.erase(at);
        }
    };
    std::vector<std::size_t> begins; // of lines that come from the slice's border
    for (const auto& [edge, to] : next)
        if (!reached.contains(edge))
            begins.push_back(edge);
    std::ranges::for_each(begins, follow);
    while (!next.empty())
        follow(next.begin()->first);
    return lines;
}

Rgb8 ColourScale::of(double value) const {
    return colour_at(map, shows() ? (value / high - low / high) / (1 - low / high) : 0);
}

ColourScale scale_for(Quantity quantity, double largest, const std::array<std::size_t, 3>& axis, double full_scale) {
    const double end = full_scale > 0 ? std::min(largest, full_scale) : largest; /* N */
    switch (quantity) {
    case Quantity::magnitude:
        return {quantity, ColourMap::sequential, 0, end, "force magnitude |F|", "force magnitude", "N"};
    case Quantity::angle:
        return {quantity, ColourMap::second, 0, largest, "angle between unshaded and shaded force", "angle", "°"};
    case Quantity::direction: { // beyond a quarter turn the colours go round, too
        const std::string words =
            fmt::format("direction of the force, from +{} towards +{}", kAxisNames[axis[1]], kAxisNames[axis[0]]);
        return largest > 90 ? ColourScale{quantity, ColourMap::cyclic, -180, 180, words, "direction", "°"}
                            : ColourScale{quantity, ColourMap::diverging, -largest, largest, words, "direction", "°"};
    }
    default:
        const std::string words = fmt::format("force along {}", kQuantityNames[static_cast<std::size_t>(quantity)]);
        return {quantity, ColourMap::diverging, -end, end, words, words, "N"};
    }
}

std::string largest_note(const ColourScale& scale, double largest) {
    if (!(largest > 0) || scale.quantity == Quantity::direction)
        return "";
    if (scale.unit == "°")
        return fmt::format(" (at most {}°)", three_digits(largest));
    const std::string end =
        scale.high < largest ? fmt::format("; the colours end at {}", quantity_text(scale.high, scale.unit)) : "";
    return fmt::format(" (at most {}{})", quantity_text(largest, scale.unit), end);
}

std::vector<std::size_t> nearest_samples(const std::vector<double>& samples, double spacing, int pixels) {
    const double extent = axis_extent(samples, spacing);
    std::vector<std::size_t> nearest(static_cast<std::size_t>(pixels));
    std::size_t sample = 0;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const double position = (static_cast<double>(i) + 0.5) / pixels * extent - spacing / 2; // from the first sample
        while (sample + 1 < samples.size() &&
               position > std::midpoint(samples[sample] - samples[0], samples[sample + 1] - samples[0]))
            ++sample;
        nearest[i] = sample;
    }
    return nearest;
}

std::vector<std::uint32_t> rasterise(const ValueSlice& slice, int width, int height, const ColourScale& scale) {
    const std::vector<std::size_t> column = nearest_samples(slice.axes.u, slice.axes.u_spacing, width);
    const std::vector<std::size_t> row = nearest_samples(slice.axes.v, slice.axes.v_spacing, height);
    std::vector<std::uint32_t> colour(slice.value.size()), pixels;
    std::ranges::transform(slice.value, colour.begin(),
                           [&](double value) { return packed(value == kNoForce ? kNoForceColour : scale.of(value)); });
    for (auto line = row.rbegin(); line != row.rend(); ++line)
        for (const std::size_t sample : column)
            pixels.push_back(colour[*line * slice.axes.u.size() + sample]);
    return pixels;
}

Window contact_window(std::span<const ValueSlice> slices, std::optional<std::array<double, 2>> reach) {
    const SliceAxes& axes = slices[0].axes;
    const std::size_t columns = axes.u.size(), rows = axes.v.size();
    Window window{columns, 0, rows, 0};
    for (const ValueSlice& slice : slices)
        for (std::size_t i = 0; i < slice.value.size(); ++i)
            if (slice.value[i] != kNoForce) {
                window.u_first = std::min(window.u_first, i % columns);
                window.u_last = std::max(window.u_last, i % columns);
                window.v_first = std::min(window.v_first, i / columns);
                window.v_last = std::max(window.v_last, i / columns);
            }
    if (window.u_first > window.u_last)
        return {0, columns - 1, 0, rows - 1};
    for (std::size_t v = 0; reach && v < rows; ++v)
        if (axes.v[v] >= (*reach)[0] && axes.v[v] <= (*reach)[1]) {
            window.v_first = std::min(window.v_first, v);
            window.v_last = std::max(window.v_last, v);
        }
    const auto widen = [](std::size_t& first, std::size_t& last, std::size_t count) {
        const std::size_t border = 1 + (last - first + 1) / 25;
        first -= std::min(first, border);
        last = std::min(last + border, count - 1);
    };
    widen(window.u_first, window.u_last, columns);
    widen(window.v_first, window.v_last, rows);
    return window;
}

ValueSlice cropped(const ValueSlice& slice, const Window& window) {
    return {cut(slice.axes, window), cut(slice.value, slice.axes.u.size(), window)};
}

FieldSlice cropped(const FieldSlice& slice, const Window& window) {
    return {cut(slice.axes, window), cut(slice.force, slice.axes.u.size(), window)};
}

namespace {

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
    slice_.force.resize(plane_.u.size() * plane_.v.size());
    for (const std::uint64_t z : even_indices(grid.size[2], kMaxTiles)) {
        const Plane& tile = tile_planes_.emplace_back(plane(2, z));
        tiles_.push_back({axes_of(tile), std::vector<double>(tile.u.size() * tile.v.size(), kNoForce)});
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
            result.push_back(grid_.at(axis, i));
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
    if (!chunk.unshaded.empty())
        unshaded_.force.resize(slice_.force.size());
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
