#include "host/referee/rounding_bound.h"

#include <algorithm>
#include <array>

namespace forceshade {

namespace {

constexpr double kOpposite = 2;     // how far two unit vectors can be apart
constexpr double kNothing = 1e-300; /* m: no divisor is less */
constexpr double kNever = std::numeric_limits<double>::infinity();

// Where the errors of a voxel come from.
struct Errors {
    double depth = 0;     /* m */
    double normal = 0;    /* 1: of the unshaded direction */
    double direction = 0; /* 1: of the force's */
    double lever = 0;     /* m: the depths that multiply the force's direction */
    double proxy = 0;     /* m */
};

struct Place {
    const layout::Law<double>& law;
    const reference::Column<double>& column;
    const reference::Contact<double>& contact;
    double x, y, z; /* m */
    const Roundoff& u;
};

double steepest(layout::uint kind, const layout::MapParams<double>& map, const std::vector<double>& samples) {
    double most = std::abs(map.slope);
    if (kind == layout::kMapSamples)
        for (const double value : samples)
            most = std::max(most, std::abs(value));
    return most;
}

// m: how far the circle's rise at x is off because R and x are rounded: much where R is barely above x.
double rise_error(const Roundoff& u, double radius, double rise) {
    const double square = u(roundings::kCircle) * radius * radius; /* m^2: of R^2 - x^2 */
    return std::min(std::sqrt(square), square / rise);
}

// Of a map's gradient at (x, y), m. `most`: the steepest slope of the map, `slope` the one here.
double gradient_error(const Roundoff& u, layout::uint kind, const layout::MapParams<double>& map, double most,
                      double slope, double x, double y) {
    const double across = x * map.inverse_length, along = y * map.inverse_length, underflow = 8 * u.tiny * (1 + most);
    switch (kind) {
    case layout::kMapCylinder:
    case layout::kMapDip: {
        const double rise = slope > 0 ? std::abs(x) / slope : map.radius;
        return underflow + slope * (u(roundings::kCylinderSlope) + rise_error(u, map.radius, rise) / rise);
    }
    case layout::kMapSine:
        return underflow + most * std::min(u(roundings::kSine) + u(roundings::kTurns) * std::abs(across), kOpposite);
    case layout::kMapGaussian:
        return underflow + u(roundings::kGaussian) * slope * (1 + across * across + along * along);
    case layout::kMapSamples:
        return underflow + most * std::min(u(roundings::kSamples) * (1.0 + map.columns + map.rows), kOpposite);
    default:
        return 0;
    }
}

double radial_error(const Place& at) {
    const double depth = at.law.params.centre_depth, distance = std::hypot(at.x, at.z + depth); /* m */
    // Close to the axis the square of the distance is not a normal number. On the axis all of this is infinite.
    return std::fmin(at.u(roundings::kRadial) * (1 + depth / distance) + at.u.tiny / (distance * distance), kOpposite);
}

Errors cylinder_errors(const Place& at) {
    const layout::LawParams<double>& params = at.law.params;
    const double both = params.radius + std::hypot(at.x, at.z + params.centre_depth); /* m: R + r */
    const double power = params.half_width * params.half_width + at.x * at.x +
                         std::abs(at.z) * (std::abs(at.z) + 2 * params.centre_depth);
    Errors errors;
    errors.depth = at.u(roundings::kCylinderDepth) * power / both + at.u.tiny * (1 + 1 / both);
    errors.normal = errors.direction = radial_error(at) + at.u.one; // the sum of two solids
    errors.lever = at.contact.depth + std::max(0.0, -at.z);
    errors.proxy = errors.depth + at.contact.depth * errors.direction + at.u.one * (std::abs(at.x) + std::abs(at.z));
    return errors;
}

// What a facet's slope, relative to itself, and its height in m lose to vertices and a radius that are rounded.
struct Facing {
    double slope = 0, height = 0;
};

Facing facing_errors(const Place& at, double slope, double left, double right, double left_height) {
    const layout::LawParams<double>& params = at.law.params;
    const double rise_left = reference::circle_rise(params.radius, left);
    const double rise_right = reference::circle_rise(params.radius, right);
    const double off_left = rise_error(at.u, params.radius, rise_left);
    Facing errors;
    errors.slope =
        (off_left + rise_error(at.u, params.radius, rise_right)) / std::max(rise_left + rise_right, kNothing);
    errors.slope += at.u(roundings::kMade);
    errors.height = slope * ((right - left) * errors.slope + at.u(roundings::kMade) * std::abs(left));
    if (left > -params.half_width) {
        const double square = at.u(roundings::kCircle) * params.half_width * params.half_width;
        errors.height += (left_height * off_left + square) / std::max(rise_left + params.centre_depth, kNothing);
    }
    return errors;
}

Errors facet_errors(const Place& at) {
    const layout::LawParams<double>& params = at.law.params;
    const layout::Features& features = at.law.features;
    const reference::Facet<double>& facet = at.column.facet;
    Errors errors;
    errors.depth = at.u.one * at.contact.depth + at.u.tiny;
    if (facet.id < params.facets)
        errors.normal = at.u(roundings::kFacetNormal) + at.u.tiny;
    if (params.facets > 1 && facet.id < params.facets) {
        const double slope = std::abs(facet.normal_x / facet.normal_z);
        const double left = at.law.facet_vertices[facet.id], right = at.law.facet_vertices[facet.id + 1];
        const double left_height =
            reference::cylinder_height(params.half_width, params.radius, params.centre_depth, left);
        const Facing facing = facing_errors(at, slope, left, right, left_height);
        errors.depth += at.u(roundings::kFacetHeight) * (left_height + slope * params.half_width) + facing.height;
        errors.normal += slope * facing.slope / (1 + slope * slope);
    }
    errors.normal = std::min(errors.normal, kOpposite);
    errors.proxy = errors.depth;
    if (features.depth == layout::kDepthNormal) {
        errors.depth += at.contact.depth * (errors.normal + at.u.one);
        errors.proxy = errors.depth + at.contact.depth * errors.normal +
                       at.u.one * (std::abs(at.x) + std::abs(at.z) + 2 * at.contact.depth);
    }
    errors.lever = at.contact.depth;
    errors.direction = errors.normal;
    if (features.shading == layout::kShadingReference)
        errors.direction = 0;
    if (features.shading == layout::kShadingReference && at.column.on_bump) {
        const double rise = reference::circle_rise(params.radius, at.x);
        errors.direction = features.reference == layout::kReferenceRadial
                               ? radial_error(at)
                               : std::min(at.u(roundings::kReference) + at.u(roundings::kGiven) + at.u.tiny +
                                              rise_error(at.u, params.radius, rise) / params.radius,
                                          kOpposite);
    }
    return errors;
}

Errors map_errors(const Place& at, double most) {
    const layout::Features& features = at.law.features;
    Errors errors;
    errors.depth = at.u.tiny;
    errors.lever = at.contact.depth;
    errors.proxy = at.u.tiny;
    if (features.map == layout::kMapNone)
        return errors;
    const auto gradient = reference::gradient_at(features.map, at.law.params.map, at.law.map_gradients, at.x, at.y);
    const double slope = std::hypot(gradient.x, gradient.y);
    const double off = gradient_error(at.u, features.map, at.law.params.map, most, slope, at.x, at.y);
    const double length = std::hypot(1, std::max(0.0, slope - off));
    // A gradient along x alone turns the normal the less, the steeper it is.
    const bool turns_in_plane = features.map == layout::kMapCylinder || features.map == layout::kMapDip;
    errors.direction = std::min(
        at.u(roundings::kMapNormal) + at.u.tiny + off / (turns_in_plane ? length * length : length), kOpposite);
    return errors;
}

} // namespace

RoundingBound::RoundingBound(const PreparedCase& prepared, Precision precision)
    : scene_(prepared.one.scene), tables_(make_tables<double>(scene_, prepared.images, Extent::nothing)), u_(precision),
      steepest_map_(steepest(tables_.features.map, tables_.params.map, tables_.map_gradients)),
      steepest_texture_(steepest(tables_.features.texture, tables_.params.texture, tables_.texture_gradients)) {}

Bound RoundingBound::at(double x, double y, double z) const {
    const layout::Law<double> law = tables_.law();
    const layout::LawParams<double>& params = law.params;
    const reference::Column<double> column = reference::column_at(law, x, y);
    const reference::Contact<double> contact = reference::contact_at(law, column, z);
    const Place place{law, column, contact, x, y, z, u_};
    const bool superposed = law.features.surface == layout::kSurfaceCylinderBump;
    const Errors errors = superposed                                     ? cylinder_errors(place)
                          : law.features.surface == layout::kSurfaceBump ? facet_errors(place)
                                                                         : map_errors(place, steepest_map_);
    const auto product = [&](double direction) {
        return params.stiffness * (errors.depth + errors.lever * (direction + u_(roundings::kForce))) + u_.tiny;
    };
    Bound bound{product(errors.direction), product(u_(roundings::kLength)), product(errors.normal), errors.depth,
                errors.proxy};
    if (law.features.texture != layout::kMapNone) {
        const double slope = std::hypot(column.texture.x, column.texture.y);
        const double off = gradient_error(u_, law.features.texture, params.texture, steepest_texture_, slope, x, y);
        // Another stiffness, and the sum of the two forces.
        const double texture =
            std::abs(params.texture_stiffness) *
                (errors.depth * slope + contact.depth * ((u_(roundings::kForce) + u_.one) * slope + off)) +
            u_.one * params.stiffness * contact.depth + u_.tiny * (1 + slope);
        bound.force += texture;
        bound.unshaded += texture;
    }
    if (superposed || law.features.texture != layout::kMapNone)
        bound.magnitude = bound.force;
    return bound;
}

Bound RoundingBound::over(double distance) const {
    const layout::LawParams<double>& params = tables_.params;
    // Two solids, and a texture on top.
    const double force = (2 * params.stiffness + std::abs(params.texture_stiffness) * steepest_texture_) * distance;
    return {force, force, force, distance, distance};
}

using Vector = reference::Vector<double>;

// What the direction of a facet's interpolated normal hangs on.
struct MeshBound::FacetShape {
    double corners = 0;
    double edge = 0;     /* 1: the shortest */
    double height = 0;   /* 1: the facet's area over its longest edge, or the shortest edge */
    double aspect = 0;   /* 1: the longest edge over the height */
    double shortest = 0; /* 1: the least length that an interpolated normal can have before it is normalised */
    double lift = 0;     /* 1: the least component along the facet's normal, of a unit normal */
};

MeshBound::FacetShape MeshBound::shape_of(layout::uint facet) const {
    const layout::MeshView<double>& mesh = law_.mesh;
    const layout::uint first = mesh.facet_begins[facet], end = mesh.facet_begins[facet + 1];
    Vector area(0.0), sum(0.0);
    double longest = 0, edge = kNever;
    const Vector origin = reference::vector_at(mesh.vertices, mesh.facet_corners[first]);
    for (layout::uint i = first; i < end; ++i) {
        const layout::uint from = mesh.facet_corners[i], to = mesh.facet_corners[i + 1 < end ? i + 1 : first];
        const Vector a = reference::vector_at(mesh.vertices, from) - origin;
        const Vector b = reference::vector_at(mesh.vertices, to) - origin;
        area = area + reference::cross(a, b);
        longest = std::max(longest, norm(b - a));
        edge = std::min(edge, norm(b - a));
        sum = sum + reference::vector_at(mesh.vertex_normals, from);
    }
    const Vector middle = reference::normalised(sum);
    const Vector normal = reference::vector_at(mesh.facet_normals, facet);
    const double height = longest > 0 ? std::min(norm(area) / 2 / longest, edge) : 0;
    FacetShape shape{double(end - first), edge, height, longest / height, 1, 1};
    for (layout::uint i = first; i < end; ++i) {
        const Vector own = reference::vector_at(mesh.vertex_normals, mesh.facet_corners[i]);
        shape.shortest = std::min(shape.shortest, reference::dot(own, middle));
        shape.lift = std::min(shape.lift, reference::dot(own, normal));
    }
    return shape;
}

namespace {

reference::MeshTouch<double> touch_of(const Vector& probe, layout::uint facet,
                                      const reference::TrianglePoint<double>& point) {
    return {facet, point.offset, Vector(probe + point.offset), std::sqrt(point.square)};
}

// The nearest point of a triangle, and those of its edges, any of which rounding may take for it: their squares may be
// alike where the points are not.
std::array<reference::TrianglePoint<double>, 4> points_of(const Vector& probe,
                                                          const reference::Triangle<double>& triangle) {
    std::array<reference::TrianglePoint<double>, 4> points{reference::nearest_on_triangle(probe, triangle)};
    for (layout::uint i = 0; i < 3; ++i) {
        const layout::uint next = (i + 1) % 3;
        const Vector edge = triangle.corners[next] - triangle.corners[i];
        const auto point =
            reference::nearest_on_edge(Vector(triangle.corners[i] - probe), Vector(triangle.corners[next] - probe),
                                       edge, reference::dot(edge, edge));
        const layout::uint feature = point.place == reference::EdgePlace::within  ? layout::kMeshEdge + i
                                     : point.place == reference::EdgePlace::start ? layout::kMeshCorner + i
                                                                                  : layout::kMeshCorner + next;
        points[i + 1] = {point.square, point.offset, feature};
    }
    return points;
}

} // namespace

MeshBound::MeshBound(const PreparedCase& prepared, Precision precision)
    : tables_(make_tables<double>(prepared.one.scene, prepared.images, Extent::nothing)), law_(tables_.law()),
      u_(precision), steepest_map_(steepest(tables_.features.map, tables_.params.map, tables_.map_gradients)),
      steepest_texture_(steepest(tables_.features.texture, tables_.params.texture, tables_.texture_gradients)) {}

double MeshBound::reach(const Vector& probe) const {
    return u_(roundings::kNearest) * (1 + std::max(1.0, reference::largest_coordinate(probe)));
}

double MeshBound::place_error(const Vector& point) const {
    const layout::MeshParams<double>& params = law_.mesh.params;
    return u_(roundings::kPlace) *
           (norm(params.centre_x, params.centre_y, params.centre_z) + params.scale * norm(point));
}

double MeshBound::map_error(const Vector& point) const {
    const layout::MeshParams<double>& params = law_.mesh.params;
    return u_(roundings::kPlace) * (std::hypot(params.map_x, params.map_y) + params.scale * norm(point));
}

double MeshBound::slope_error(layout::uint kind, const layout::MapParams<double>& map, std::span<const double> samples,
                              double steepest, const reference::MeshTouch<double>& touch, double off) const {
    const auto place = reference::map_place(law_.mesh.params, touch.point);
    const auto at = [&](double dx, double dy) {
        return reference::gradient_at(kind, map, samples, place.x + dx, place.y + dy);
    };
    const double moved = off * law_.mesh.params.scale + map_error(touch.point); /* m */
    const auto here = at(0, 0);
    double most = 0;
    for (const auto& [dx, dy] : {std::pair(moved, 0.0), {-moved, 0.0}, {0.0, moved}, {0.0, -moved}}) {
        const auto there = at(dx, dy);
        most = std::max(most, std::hypot(there.x - here.x, there.y - here.y));
    }
    return 2 * most + gradient_error(u_, kind, map, steepest, std::hypot(here.x, here.y), place.x, place.y) + u_.tiny;
}

double MeshBound::direction_error(const reference::MeshTouch<double>& touch, const FacetShape& shape,
                                  double off) const {
    const layout::Features& features = law_.features;
    double error = 0, lift = 1;
    if (features.shading != layout::kShadingNone) {
        if (!(shape.shortest > 0) || !(shape.height > 0))
            return kOpposite;
        const double rounding =
            features.shading == layout::kShadingMorgenbesser  ? u_(roundings::kMorgenbesser) + u_.one * shape.corners
            : features.shading == layout::kShadingBarycentric ? u_(roundings::kBarycentric) * (1 + shape.aspect)
                                                              : u_(roundings::kMeanValue) * (1 + shape.aspect);
        error = (rounding + roundings::kTurn * off / shape.height) / shape.shortest;
        lift = shape.lift;
    }
    if (features.map != layout::kMapNone) {
        const double slope = slope_error(features.map, law_.params.map, law_.map_gradients, steepest_map_, touch, off);
        const auto place = reference::map_place(law_.mesh.params, touch.point);
        const auto here = reference::gradient_at(features.map, law_.params.map, law_.map_gradients, place.x, place.y);
        error = lift > 0 ? (error + slope + u_(roundings::kTilt) * (1 + std::hypot(here.x, here.y))) / lift : kOpposite;
    }
    return std::min(error, kOpposite);
}

Bound MeshBound::at(const Vector& probe, const reference::MeshTouch<double>& touch) const {
    const layout::MeshParams<double>& params = law_.mesh.params;
    const FacetShape shape = shape_of(touch.facet);
    const double height = reference::dot(touch.offset, reference::vector_at(law_.mesh.facet_normals, touch.facet));
    double off = reach(probe);
    // A point that is on no face: where vertices are rounded, an edge turns.
    if (height * height < (1 - 1e-12) * touch.distance * touch.distance)
        off *= 1 + touch.distance / shape.edge;
    const double unshaded = std::abs(params.stiffness) * touch.distance; /* N */
    const double plain = std::abs(params.stiffness) * off + u_(roundings::kForce) * unshaded + u_.tiny;
    const bool shaded = law_.features.shading != layout::kShadingNone || law_.features.map != layout::kMapNone;
    Bound bound{plain + (shaded ? unshaded * direction_error(touch, shape, off) : 0),
                plain + u_(roundings::kLength) * unshaded, plain, off * params.scale,
                off * params.scale + place_error(touch.point)};
    if (law_.features.shading == layout::kShadingTwoPass) {
        bound.force = shape.lift > 0 ? 2 * bound.force / (shape.lift * shape.lift) : kNever;
        bound.magnitude = bound.force;
    }
    if (law_.features.texture != layout::kMapNone) {
        const auto place = reference::map_place(params, touch.point);
        const auto slope = reference::gradient_at(law_.features.texture, law_.params.texture, law_.texture_gradients,
                                                  place.x, place.y);
        const double steep = std::hypot(slope.x, slope.y);
        const double error = slope_error(law_.features.texture, law_.params.texture, law_.texture_gradients,
                                         steepest_texture_, touch, off);
        const double products = (u_(roundings::kForce) + u_(roundings::kTilt)) * steep;
        const double pull = std::abs(law_.params.texture_stiffness) * params.scale *
                                (off * steep + touch.distance * (products + error)) +
                            u_.one * unshaded;
        bound.force += pull;
        bound.unshaded += pull;
        bound.magnitude = bound.force;
    }
    return bound;
}

Verdict MeshBound::compare(const Reading& computed, const Vector& probe, double sides, layout::uint channels) const {
    const layout::MeshView<double>& mesh = law_.mesh;
    const reference::Nearest<double> found = reference::nearest(mesh, probe);
    const double slack = 2 * sides * reach(probe), nearest = std::sqrt(found.square);
    const auto fits_free = [&] {
        return !first_misfit(computed, reading_of(reference::free_contact(law_, probe)),
                             {0, 0, 0, 0, sides * place_error(probe)}, channels);
    };
    const auto fits = [&](const reference::MeshTouch<double>& touch) {
        return !first_misfit(computed, reading_of(reference::touching_contact(law_, touch)), sides * at(probe, touch),
                             channels);
    };
    const bool inside = reference::is_inside(law_, found, probe);
    if (inside ? fits(touch_of(probe, found.facet, {found.square, found.offset, found.feature})) : fits_free())
        return Verdict::within;
    const bool either = nearest <= slack;
    if (either && fits_free())
        return Verdict::on_edge;
    for (layout::uint triangle = 0; triangle < mesh.params.triangles; ++triangle) {
        const reference::Triangle<double> shape = reference::triangle_at(mesh, triangle);
        const layout::uint facet = mesh.triangle_facets[triangle];
        if (!(std::sqrt(reference::nearest_on_triangle(probe, shape).square) <= nearest + slack))
            continue;
        for (const auto& point : points_of(probe, shape)) {
            if (!(std::sqrt(point.square) <= nearest + slack))
                continue;
            const bool here =
                reference::is_inside(law_, {triangle, facet, point.feature, point.offset, point.square}, probe);
            if ((here || either) && fits(touch_of(probe, facet, point)))
                return Verdict::on_edge;
            if (!here && fits_free())
                return Verdict::on_edge;
        }
    }
    return Verdict::beyond;
}

bool MeshBound::is_ambiguous(const Vector& computed, const Vector& probe, const Vector& exact) const {
    const double off = norm(computed - exact);
    // Few voxels are so far off that it is worth asking.
    if (off <= std::abs(law_.mesh.params.stiffness) * reach(probe))
        return false;
    const auto verdict = [&](const Vector& force) {
        Reading reading;
        reading.force = force;
        return compare(reading, probe, 1, layout::kChannelForce);
    };
    const Verdict own = verdict(computed);
    return own == Verdict::on_edge || (own == Verdict::within && verdict(exact) == Verdict::on_edge);
}

} // namespace forceshade
