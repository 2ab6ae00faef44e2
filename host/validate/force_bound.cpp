#include "host/validate/force_bound.h"

#include <algorithm>
#include <cmath>

#include "host/reference/contact.h"

namespace forceshade {
namespace {

constexpr double kRoundings = 64;

double largest(const std::vector<double>& values) {
    double most = 0;
    for (const double value : values)
        most = std::max(most, std::abs(value));
    return most;
}

// How far a map's gradient may be off, in units of kRoundings u.
double gradient_term(layout::uint kind, const layout::MapParams<double>& map, double largest_sample, double slope,
                     double x, double y) {
    switch (kind) {
    case layout::kMapCylinder:
    case layout::kMapDip:
        return 1 + slope;
    case layout::kMapSine:
        return std::abs(map.slope) * (1 + std::abs(x * map.inverse_length));
    case layout::kMapGaussian:
        return slope * (1 + (x * x + y * y) * map.inverse_length * map.inverse_length);
    case layout::kMapSamples:
        return largest_sample * (1.0 + map.columns + map.rows);
    default:
        return 0;
    }
}

} // namespace

ForceBound::ForceBound(const PreparedCase& prepared, double unit_roundoff)
    : scene_(prepared.one.scene), tables_(make_tables<double>(scene_, prepared.images, Extent::what_varies)),
      roundoff_(unit_roundoff), largest_map_slope_(largest(tables_.map_gradients)),
      largest_texture_slope_(largest(tables_.texture_gradients)) {}

double ForceBound::at(double x, double y, double z) const {
    const layout::Law<double> law = tables_.law();
    const layout::LawParams<double>& params = law.params;
    const reference::Column<double> column = reference::column_at(law, x, y);
    const reference::Contact<double> contact = reference::contact_at(law, column, z);
    double depth = contact.depth;            // m, the longest that multiplies a direction
    double depth_term = std::abs(z) + depth; // m, in units of kRoundings u
    double direction_term = 1;               // 1, likewise
    const double rise = z + params.centre_depth;
    const double distance = std::max(std::hypot(x, rise), 1e-300);
    const double radial_term = 1 + (std::abs(z) + params.centre_depth + std::abs(x)) / distance;
    if (scene_.surface.kind == SurfaceKind::cylinder_bump) {
        const double a = params.half_width;
        depth_term +=
            (a * a + x * x + std::abs(z) * (std::abs(z) + 2 * params.centre_depth)) / (params.radius + distance);
        direction_term = radial_term;
        depth += std::max(0.0, -z);
    } else if (scene_.surface.kind == SurfaceKind::bump) {
        const double top = reference::cylinder_height(params.half_width, params.radius, params.centre_depth, 0.0);
        const double slope = std::abs(column.facet.normal_x / column.facet.normal_z);
        const double smooth =
            column.on_bump ? std::abs(x) / std::max(reference::circle_rise(params.radius, x), 1e-300) : 0;
        depth_term += top + 2 * slope * params.half_width;
        direction_term = 1 + std::min(slope + smooth, 1e9);
        if (law.features.reference == layout::kReferenceRadial)
            direction_term += radial_term;
    } else if (law.features.map != layout::kMapNone) {
        const auto gradient = reference::gradient_at(law.features.map, params.map, law.map_gradients, x, y);
        const double slope = std::hypot(gradient.x, gradient.y);
        direction_term += gradient_term(law.features.map, params.map, largest_map_slope_, slope, x, y);
    }
    const double unit = kRoundings * roundoff_;
    double bound = unit * params.stiffness * (depth_term + depth * direction_term);
    if (law.features.texture != layout::kMapNone) {
        const double slope = std::hypot(column.texture.x, column.texture.y);
        const double term = gradient_term(law.features.texture, params.texture, largest_texture_slope_, slope, x, y);
        bound += unit * std::abs(params.texture_stiffness) * (depth_term * slope + depth * (slope + term));
    }
    return bound;
}

} // namespace forceshade
