#include "host/referee/rounding_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forceshade {

namespace {

constexpr double kRoundings = 64;
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
    double unit, tiny;
};

double steepest(layout::uint kind, const layout::MapParams<double>& map, const std::vector<double>& samples) {
    double most = std::abs(map.slope);
    if (kind == layout::kMapSamples)
        for (const double value : samples)
            most = std::max(most, std::abs(value));
    return most;
}

double gradient_error(layout::uint kind, const layout::MapParams<double>& map, double most, double slope,
                      const Place& at) {
    const auto times_most = [&](double roundings) { return most * std::min(at.unit * roundings, kOpposite); };
    const double u = at.x * map.inverse_length, v = at.y * map.inverse_length;
    const double underflow = 8 * at.tiny * (1 + most);
    switch (kind) {
    case layout::kMapCylinder:
    case layout::kMapDip:
        return underflow + at.unit * (1 + slope) * std::hypot(1, slope);
    case layout::kMapSine:
        return underflow + times_most(1 + std::abs(u));
    case layout::kMapGaussian:
        return underflow + at.unit * slope * (1 + u * u + v * v);
    case layout::kMapSamples:
        return underflow + times_most(1.0 + map.columns + map.rows);
    default:
        return 0;
    }
}

double radial_error(const Place& at) {
    const double depth = at.law.params.centre_depth, distance = std::hypot(at.x, at.z + depth); /* m */
    const double roundings = 1 + (std::abs(at.x) + std::abs(at.z) + depth) / distance;
    // Close to the axis the square of the distance is no normal number. On the axis all of this is infinite.
    return std::fmin(at.unit * roundings + at.tiny / (distance * distance), kOpposite);
}

Errors cylinder_errors(const Place& at) {
    const layout::LawParams<double>& params = at.law.params;
    const double both = params.radius + std::hypot(at.x, at.z + params.centre_depth); /* m: R + r */
    const double power = params.half_width * params.half_width + at.x * at.x +
                         std::abs(at.z) * (std::abs(at.z) + 2 * params.centre_depth);
    Errors errors;
    errors.depth = at.unit * (std::abs(at.z) + at.contact.depth + power / both) + at.tiny * (1 + 1 / both);
    errors.normal = errors.direction = radial_error(at);
    errors.lever = at.contact.depth + std::max(0.0, -at.z);
    errors.proxy = errors.depth + at.contact.depth * errors.direction + at.unit * (std::abs(at.x) + std::abs(at.z));
    return errors;
}

// How far the circle's rise at a vertex is off because R and the vertex are rounded, m: much where R is barely above
// it.
double rise_error(const Place& at, double rise) {
    const double radius = at.law.params.radius, roundoff = at.unit / kRoundings;
    return std::min(2 * radius * std::sqrt(roundoff), 4 * roundoff * radius * radius / rise);
}

// What a facet's slope, relative to itself, and its height in m lose to rises that are off.
struct Facing {
    double slope = 0, height = 0;
};

Facing facing_errors(const Place& at, double slope) {
    const layout::LawParams<double>& params = at.law.params;
    const double left = at.law.facet_vertices[at.column.facet.id],
                 right = at.law.facet_vertices[at.column.facet.id + 1];
    const double rise_left = reference::circle_rise(params.radius, left);
    const double rise_right = reference::circle_rise(params.radius, right);
    const double off_left = rise_error(at, rise_left);
    Facing errors;
    errors.slope = (off_left + rise_error(at, rise_right)) / std::max(rise_left + rise_right, kNothing);
    errors.height = slope * (right - left) * errors.slope;
    if (left > -params.half_width) {
        const double height = reference::cylinder_height(params.half_width, params.radius, params.centre_depth, left);
        const double square = 4 * at.unit / kRoundings * params.half_width * params.half_width;
        errors.height += (height * off_left + square) / std::max(rise_left + params.centre_depth, kNothing);
    }
    return errors;
}

Errors facet_errors(const Place& at) {
    const layout::LawParams<double>& params = at.law.params;
    const layout::Features& features = at.law.features;
    const reference::Facet<double>& facet = at.column.facet;
    Errors errors;
    errors.depth = at.unit * (std::abs(at.z) + at.contact.depth) + at.tiny;
    const double slope = std::abs(facet.normal_x / facet.normal_z);
    errors.normal = at.unit * (1 + slope) + at.tiny;
    if (params.facets > 1 && facet.id < params.facets) {
        const Facing facing = facing_errors(at, slope);
        const double top = reference::cylinder_height(params.half_width, params.radius, params.centre_depth, 0.0);
        errors.depth += at.unit * (2 * slope * params.half_width + top) + facing.height;
        errors.normal += slope * facing.slope / (1 + slope * slope);
    }
    errors.normal = std::min(errors.normal, kOpposite);
    errors.proxy = errors.depth;
    if (features.depth == layout::kDepthNormal) {
        errors.depth += at.contact.depth * errors.normal;
        errors.proxy = errors.depth + at.contact.depth * errors.normal + at.unit * (std::abs(at.x) + std::abs(at.z));
    }
    errors.lever = at.contact.depth;
    errors.direction = errors.normal;
    if (features.shading == layout::kShadingReference && at.column.on_bump) {
        const double smooth = std::abs(at.x) / reference::circle_rise(params.radius, at.x);
        errors.direction = features.reference == layout::kReferenceRadial
                               ? radial_error(at)
                               : std::min(at.unit * (1 + smooth) + at.tiny, kOpposite);
    }
    return errors;
}

Errors map_errors(const Place& at, double most) {
    const layout::Features& features = at.law.features;
    Errors errors;
    errors.depth = at.unit * (std::abs(at.z) + at.contact.depth) + at.tiny;
    errors.normal = at.unit + at.tiny;
    errors.lever = at.contact.depth;
    errors.proxy = at.tiny;
    const auto gradient = reference::gradient_at(features.map, at.law.params.map, at.law.map_gradients, at.x, at.y);
    const double slope = std::hypot(gradient.x, gradient.y);
    const double off = gradient_error(features.map, at.law.params.map, most, slope, at);
    errors.direction = errors.normal + std::min(off / std::hypot(1, std::max(0.0, slope - off)), kOpposite);
    return errors;
}

} // namespace

RoundingBound::RoundingBound(const PreparedCase& prepared, Precision precision)
    : scene_(prepared.one.scene), tables_(make_tables<double>(scene_, prepared.images, Extent::what_varies)),
      unit_(kRoundings * (precision == Precision::f32 ? 0x1p-24 : 0x1p-53)),
      tiny_(4 * (precision == Precision::f32 ? 0x1p-126 : 0x1p-1022)),
      steepest_map_(steepest(tables_.features.map, tables_.params.map, tables_.map_gradients)),
      steepest_texture_(steepest(tables_.features.texture, tables_.params.texture, tables_.texture_gradients)) {}

Bound RoundingBound::at(double x, double y, double z) const {
    const layout::Law<double> law = tables_.law();
    const layout::LawParams<double>& params = law.params;
    const reference::Column<double> column = reference::column_at(law, x, y);
    const reference::Contact<double> contact = reference::contact_at(law, column, z);
    const Place place{law, column, contact, x, y, z, unit_, tiny_};
    const bool superposed = law.features.surface == layout::kSurfaceCylinderBump;
    const Errors errors = superposed                                     ? cylinder_errors(place)
                          : law.features.surface == layout::kSurfaceBump ? facet_errors(place)
                                                                         : map_errors(place, steepest_map_);
    const auto product = [&](double direction) {
        return params.stiffness * (errors.depth + errors.lever * direction) + tiny_;
    };
    Bound bound{product(errors.direction), product(unit_), product(errors.normal), errors.depth, errors.proxy};
    if (law.features.texture != layout::kMapNone) {
        const double slope = std::hypot(column.texture.x, column.texture.y);
        const double off = gradient_error(law.features.texture, params.texture, steepest_texture_, slope, place);
        const double texture =
            std::abs(params.texture_stiffness) * (errors.depth * slope + contact.depth * (unit_ * slope + off)) +
            tiny_ * (1 + slope);
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

namespace {

using Vector = reference::Vector<double>;

// What the direction of a facet's interpolated normal hangs on.
struct FacetShape {
    double height = 0;   /* 1: the facet's area over its longest edge */
    double shortest = 0; /* 1: the least length that an interpolated normal can have before it is normalised */
    double lift = 0;     /* 1: the least component along the facet's normal, of a unit normal */
};

FacetShape shape_of(const layout::MeshView<double>& mesh, layout::uint facet) {
    const layout::uint first = mesh.facet_begins[facet], end = mesh.facet_begins[facet + 1];
    Vector area(0.0), sum(0.0);
    double longest = 0;
    const Vector origin = reference::vector_at(mesh.vertices, mesh.facet_corners[first]);
    for (layout::uint i = first; i < end; ++i) {
        const layout::uint from = mesh.facet_corners[i], to = mesh.facet_corners[i + 1 < end ? i + 1 : first];
        const Vector a = reference::vector_at(mesh.vertices, from) - origin;
        const Vector b = reference::vector_at(mesh.vertices, to) - origin;
        area = area + reference::cross(a, b);
        longest = std::max(longest, norm(b - a));
        sum = sum + reference::vector_at(mesh.vertex_normals, from);
    }
    const Vector middle = reference::normalised(sum);
    const Vector normal = reference::vector_at(mesh.facet_normals, facet);
    FacetShape shape{longest > 0 ? norm(area) / 2 / longest : 0, 1, 1};
    for (layout::uint i = first; i < end; ++i) {
        const Vector own = reference::vector_at(mesh.vertex_normals, mesh.facet_corners[i]);
        shape.shortest = std::min(shape.shortest, reference::dot(own, middle));
        shape.lift = std::min(shape.lift, reference::dot(own, normal));
    }
    return shape;
}

reference::MeshTouch<double> touch_of(const Vector& probe, layout::uint facet,
                                      const reference::TrianglePoint<double>& point) {
    return {facet, point.offset, Vector(probe + point.offset), std::sqrt(point.square)};
}

} // namespace

MeshBound::MeshBound(const PreparedCase& prepared, Precision precision)
    : tables_(make_tables<double>(prepared.one.scene, prepared.images, Extent::what_varies)), law_(tables_.law()),
      unit_(kRoundings * (precision == Precision::f32 ? 0x1p-24 : 0x1p-53)),
      tiny_(4 * (precision == Precision::f32 ? 0x1p-126 : 0x1p-1022)) {}

double MeshBound::reach(const Vector& probe) const {
    return unit_ * (1 + std::max(1.0, reference::largest_coordinate(probe)));
}

double MeshBound::slope_error(layout::uint kind, const layout::MapParams<double>& map, std::span<const double> samples,
                              const Vector& world, double reach) const {
    const auto at = [&](double dx, double dy) {
        return reference::gradient_at(kind, map, samples, world.x + dx, world.y + dy);
    };
    const double centre = std::max(std::abs(world.x), std::abs(world.y));
    const double off = reach * law_.mesh.params.scale + unit_ * centre; /* m */
    const auto here = at(0, 0);
    double most = 0;
    for (const auto& [dx, dy] : {std::pair(off, 0.0), {-off, 0.0}, {0.0, off}, {0.0, -off}}) {
        const auto there = at(dx, dy);
        most = std::max(most, std::hypot(there.x - here.x, there.y - here.y));
    }
    const double turns = centre * std::abs(map.inverse_length) + map.columns + map.rows;
    return 2 * most + unit_ * (1 + turns) * (std::hypot(here.x, here.y) + std::abs(map.slope)) + tiny_;
}

double MeshBound::direction_error(const reference::MeshTouch<double>& touch, double reach) const {
    const layout::Features& features = law_.features;
    double error = unit_;
    if (features.shading != layout::kShadingNone) {
        const FacetShape shape = shape_of(law_.mesh, touch.facet);
        if (!(shape.shortest > 0) || !(shape.height > 0))
            return kOpposite;
        error = (unit_ + 8 * reach / shape.height) / shape.shortest;
    }
    if (features.map != layout::kMapNone)
        error += slope_error(features.map, law_.params.map, law_.map_gradients,
                             reference::to_world(law_.mesh.params, touch.point), reach);
    return std::min(error, kOpposite);
}

Bound MeshBound::at(const Vector& probe, const reference::MeshTouch<double>& touch) const {
    const layout::MeshParams<double>& params = law_.mesh.params;
    const double off = reach(probe);
    const double plain = std::abs(params.stiffness) * off + tiny_; /* N */
    const double unshaded = std::abs(params.stiffness) * touch.distance;
    const bool shaded = law_.features.shading != layout::kShadingNone || law_.features.map != layout::kMapNone;
    const double turned = shaded ? unshaded * direction_error(touch, off) : 0;
    Bound bound{plain + turned, plain + unit_ * unshaded, plain + unit_ * unshaded, off * params.scale,
                off * params.scale + unit_ * norm(params.centre_x, params.centre_y, params.centre_z)};
    if (law_.features.shading == layout::kShadingTwoPass) {
        const double lift = shape_of(law_.mesh, touch.facet).lift;
        bound.force = lift > 0 ? 2 * bound.force / (lift * lift) : kNever;
        bound.magnitude = bound.force;
    }
    if (law_.features.texture != layout::kMapNone) {
        const Vector world = reference::to_world(params, touch.point);
        const auto slope = reference::gradient_at(law_.features.texture, law_.params.texture, law_.texture_gradients,
                                                  world.x, world.y);
        const double steep = std::hypot(slope.x, slope.y);
        const double error =
            slope_error(law_.features.texture, law_.params.texture, law_.texture_gradients, world, off);
        const double pull = std::abs(law_.params.texture_stiffness) * params.scale *
                            (off * steep + touch.distance * (unit_ * steep + error));
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
        const double off = sides * reach(probe) * mesh.params.scale +
                           unit_ * norm(mesh.params.centre_x, mesh.params.centre_y, mesh.params.centre_z);
        return !first_misfit(computed, reading_of(reference::free_contact(law_, probe)), {0, 0, 0, 0, off}, channels);
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
        const auto point = reference::nearest_on_triangle(probe, reference::triangle_at(mesh, triangle));
        if (!(std::sqrt(point.square) <= nearest + slack))
            continue;
        const layout::uint facet = mesh.triangle_facets[triangle];
        const bool here =
            reference::is_inside(law_, {triangle, facet, point.feature, point.offset, point.square}, probe);
        if (here || either ? fits(touch_of(probe, facet, point)) : false)
            return Verdict::on_edge;
        if (!here && fits_free())
            return Verdict::on_edge;
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
