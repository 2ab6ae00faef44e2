#include "host/referee/referee.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

#include "host/norm.h"
#include "host/output/height_image.h"

namespace forceshade {

Bound operator+(const Bound& a, const Bound& b) {
    return {a.force + b.force, a.magnitude + b.magnitude, a.unshaded + b.unshaded, a.depth + b.depth,
            a.proxy + b.proxy};
}

Bound operator*(double factor, const Bound& bound) {
    return {factor * bound.force, factor * bound.magnitude, factor * bound.unshaded, factor * bound.depth,
            factor * bound.proxy};
}

layout::uint first_misfit(const Reading& computed, const Reading& truth, const Bound& allowed, layout::uint channels) {
    // Written so that no number is a misfit.
    if (channels & layout::kChannelForce && !(norm(computed.force - truth.force) <= allowed.force &&
                                              std::abs(norm(computed.force) - norm(truth.force)) <= allowed.magnitude))
        return layout::kChannelForce;
    if (channels & layout::kChannelDepth && !(std::abs(computed.depth - truth.depth) <= allowed.depth))
        return layout::kChannelDepth;
    if (channels & layout::kChannelFacet && computed.facet != truth.facet)
        return layout::kChannelFacet;
    if (channels & layout::kChannelProxy && !(norm(computed.proxy - truth.proxy) <= allowed.proxy))
        return layout::kChannelProxy;
    if (channels & layout::kChannelUnshaded && !(norm(computed.unshaded - truth.unshaded) <= allowed.unshaded))
        return layout::kChannelUnshaded;
    return 0;
}

std::string describe(const Reading& reading, layout::uint channel) {
    const auto vector = [](const char* name, const glm::dvec3& value, const char* unit) {
        return fmt::format("{} ({}, {}, {}) {}", name, value.x, value.y, value.z, unit);
    };
    switch (channel) {
    case layout::kChannelDepth:
        return fmt::format("depth {} m", reading.depth);
    case layout::kChannelFacet:
        return fmt::format("facet {}", reading.facet);
    case layout::kChannelProxy:
        return vector("proxy", reading.proxy, "m");
    case layout::kChannelUnshaded:
        return vector("unshaded", reading.unshaded, "N");
    default:
        return vector("force", reading.force, "N");
    }
}

} // namespace forceshade

namespace forceshade::brute {

namespace {

// The slope of a sampled map at a node: central difference, one-sided at the border.
struct Samples {
    const HeightImage& image;
    const HeightMapSpec& map;

    Real height(long column, long row) const { // row 0 at the smallest y
        const auto index = (static_cast<long>(image.rows) - 1 - row) * static_cast<long>(image.columns) + column;
        return Real(map.height) * Real(image.samples[static_cast<std::size_t>(index)]);
    }
    std::array<Real, 2> slope(long column, long row) const {
        const long last_column = static_cast<long>(image.columns) - 1, last_row = static_cast<long>(image.rows) - 1;
        const long west = std::max(column - 1, 0L), east = std::min(column + 1, last_column);
        const long south = std::max(row - 1, 0L), north = std::min(row + 1, last_row);
        std::array<Real, 2> result{};
        if (east > west)
            result[0] =
                (height(east, row) - height(west, row)) / (Real(map.size[0]) * Real(east - west) / Real(last_column));
        if (north > south)
            result[1] = (height(column, north) - height(column, south)) /
                        (Real(map.size[1]) * Real(north - south) / Real(last_row));
        return result;
    }
    // The four nodes about (x, y), each weighted by the area opposite to it.
    std::array<Real, 2> at(Real x, Real y) const {
        const long last_column = static_cast<long>(image.columns) - 1, last_row = static_cast<long>(image.rows) - 1;
        const Real across = (x / Real(map.size[0]) + Real(0.5)) * Real(last_column);
        const Real along = (y / Real(map.size[1]) + Real(0.5)) * Real(last_row);
        const long column = std::clamp(static_cast<long>(std::floor(across)), 0L, std::max(last_column - 1, 0L));
        const long row = std::clamp(static_cast<long>(std::floor(along)), 0L, std::max(last_row - 1, 0L));
        std::array<Real, 2> sum{};
        for (long j = 0; j < 2; ++j)
            for (long i = 0; i < 2; ++i) {
                const Real weight = (i ? across - Real(column) : Real(column + 1) - across) *
                                    (j ? along - Real(row) : Real(row + 1) - along);
                const auto node = slope(std::min(column + i, last_column), std::min(row + j, last_row));
                sum[0] += weight * node[0];
                sum[1] += weight * node[1];
            }
        return sum;
    }
};

// How far the circle of this radius stands above its centre at x.
Real rise_of_circle(Real radius, Real x) {
    return std::sqrt((radius - x) * (radius + x));
}

// The angle from z to the circle's normal at x. An arc sine would lose half of the digits where R is barely above x.
Real angle_of_circle(Real radius, Real x) {
    return std::atan2(x, rise_of_circle(radius, x));
}

Vector tilted(Real angle) {
    return {std::sin(angle), 0, std::cos(angle)};
}

} // namespace

Referee::Referee(const Scene& scene, const SceneImages& images)
    : scene_(scene), images_(images), half_width_(Real(scene.surface.width) / 2), radius_(scene.surface.radius),
      edge_angle_(angle_of_circle(radius_, half_width_)),
      axis_depth_(rise_of_circle(radius_, half_width_)), // exactly 0 for R = a
      top_(2 * radius_ * std::sin(edge_angle_ / 2) * std::sin(edge_angle_ / 2)) {}

Real Referee::texture_stiffness() const {
    return scene_.texture ? Real(scene_.texture->stiffness) : Real(0);
}

std::array<Real, 2> map_slope(const HeightMapSpec& map, const HeightImage* image, Real x, Real y) {
    constexpr Real kPi = std::numbers::pi_v<Real>;
    const Real radius = map.radius, height = map.height;
    switch (map.function) {
    case MapFunction::cylinder:
    case MapFunction::dip:
        if (std::abs(x) >= Real(map.width) / 2)
            return {};
        return {(map.function == MapFunction::dip ? 1 : -1) * x / rise_of_circle(radius, x), 0};
    case MapFunction::sine: {
        const Real wavelength = map.width;
        return {2 * kPi * height / wavelength * std::cos(2 * kPi * std::fmod(x, wavelength) / wavelength), 0};
    }
    case MapFunction::gaussian: {
        const Real u = height * std::exp(-(x * x + y * y) / (radius * radius));
        return {-2 * x / (radius * radius) * u, -2 * y / (radius * radius) * u};
    }
    case MapFunction::file:
        if (2 * std::abs(x) > Real(map.size[0]) || 2 * std::abs(y) > Real(map.size[1]))
            return {};
        return Samples{*image, map}.at(x, y);
    }
    return {};
}

Column Referee::column(double x, double y) const {
    Column column{.x = x, .y = y};
    const bool bump = scene_.surface.kind == SurfaceKind::bump;
    column.on_bump = scene_.surface.kind != SurfaceKind::height_map && std::abs(column.x) < half_width_;
    if (scene_.texture)
        column.texture = map_slope(scene_.texture->map, images_.texture.get(), x, y);
    if (scene_.surface.kind == SurfaceKind::height_map && scene_.force.shading == Shading::height_map) {
        const auto slope = map_slope(scene_.surface.map, images_.map.get(), x, y);
        const Real length = std::sqrt(slope[0] * slope[0] + slope[1] * slope[1] + 1);
        column.smooth = {-slope[0] / length, -slope[1] / length, 1 / length};
    }
    if (bump && column.on_bump)
        column.smooth = tilted(angle_of_circle(radius_, column.x));
    if (!bump)
        return column;
    const std::uint32_t facets = scene_.surface.facets;
    column.facet = facets;
    const bool by_arc = scene_.surface.facet_spacing == FacetSpacing::equal_arc;
    const auto angle = [&](std::uint32_t i) {
        const Real fraction = (2 * Real(i) - Real(facets)) / Real(facets);
        return by_arc ? edge_angle_ * fraction : angle_of_circle(radius_, half_width_ * fraction);
    };
    // Facet i faces halfway between its vertices' angles; heights by the product form of a difference of cosines.
    Real left = angle(0);
    for (std::uint32_t i = 0; i < facets; ++i) {
        const Real right = angle(i + 1);
        const Real begin = i == 0 ? -half_width_ : radius_ * std::sin(left);
        const Real end = i + 1 == facets ? half_width_ : radius_ * std::sin(right);
        if (column.x >= begin && column.x < end) {
            column.facet = i;
            column.facet_angle = (left + right) / 2;
            const Real vertex_height =
                2 * radius_ * std::sin((edge_angle_ + left) / 2) * std::sin((edge_angle_ - left) / 2);
            column.height = vertex_height - std::tan(column.facet_angle) * (column.x - begin);
            break;
        }
        left = right;
    }
    return column;
}

Answer Referee::cylinder_bump(const Column& column, Real z) const {
    Answer answer;
    answer.proxy = {column.x, column.y, z};
    const Real rise = z + axis_depth_;
    const Real distance = std::hypot(column.x, rise);
    const Real plane = std::max(Real(0), -z);
    // R - r from the cylinder's top, where R may be a billion times what is left: r^2 = x^2 + (R + w)^2.
    const Real below_top = z - top_;
    const Real power = column.x * column.x + below_top * (2 * radius_ + below_top);
    const Real cylinder = std::max(Real(0), -power / (radius_ + distance));
    if (plane == 0 && cylinder == 0)
        return answer;
    const Vector outward = distance > 0 ? tilted(std::atan2(column.x, rise)) : tilted(0);
    answer.depth = std::max(plane, cylinder);
    answer.facet = cylinder >= plane ? 0 : 1;
    answer.force = Real(scene_.force.stiffness) * cylinder * outward;
    answer.force.z += Real(scene_.force.stiffness) * plane;
    answer.proxy.z = 0;
    if (cylinder >= plane)
        answer.proxy = {column.x + cylinder * outward.x, column.y, z + cylinder * outward.z};
    return answer;
}

Answer Referee::facets(const Column& column, Real z) const {
    Answer answer;
    answer.proxy = {column.x, column.y, z};
    const Real vertical = column.height - z;
    if (!(vertical > 0))
        return answer;
    const bool normal_depth = scene_.force.depth == DepthReading::normal;
    const Vector normal = tilted(column.facet_angle);
    answer.depth = normal_depth ? vertical * std::cos(column.facet_angle) : vertical;
    answer.facet = column.facet;
    answer.proxy.z = column.height;
    if (normal_depth)
        answer.proxy = {column.x + answer.depth * normal.x, column.y, z + answer.depth * normal.z};
    Vector direction = column.smooth;
    if (scene_.force.shading == Shading::none)
        direction = normal;
    else if (scene_.force.shading == Shading::reference && scene_.force.reference == ReferenceDirection::radial)
        direction = column.on_bump ? tilted(std::atan2(column.x, z + axis_depth_)) : tilted(0);
    answer.force = Real(scene_.force.stiffness) * answer.depth * direction;
    answer.unshaded = Real(scene_.force.stiffness) * answer.depth * normal;
    return answer;
}

Answer Referee::at(const Column& column, double z) const {
    const bool superposed = scene_.surface.kind == SurfaceKind::cylinder_bump;
    Answer answer = superposed ? cylinder_bump(column, z) : facets(column, z);
    if (superposed)
        answer.unshaded = answer.force;
    for (Vector* force : {&answer.force, &answer.unshaded}) {
        force->x -= texture_stiffness() * answer.depth * column.texture[0];
        force->y -= texture_stiffness() * answer.depth * column.texture[1];
    }
    return answer;
}

} // namespace forceshade::brute
