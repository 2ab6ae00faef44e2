#include "host/validate/mesh_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "host/norm.h"

namespace forceshade {
namespace {

using Vector = reference::Vector<double>;

constexpr double kRoundings = 64;
constexpr double kOpposite = 2; // how far two unit vectors can be apart
constexpr double kNever = std::numeric_limits<double>::infinity();

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
        longest = std::max(longest, norm(b.x - a.x, b.y - a.y, b.z - a.z));
        sum = sum + reference::vector_at(mesh.vertex_normals, from);
    }
    const Vector middle = reference::normalised(sum);
    const Vector normal = reference::vector_at(mesh.facet_normals, facet);
    FacetShape shape{longest > 0 ? norm(area.x, area.y, area.z) / 2 / longest : 0, 1, 1};
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

MeshBound::Verdict MeshBound::judge(const Reading& computed, const Vector& probe, double sides,
                                    layout::uint channels) const {
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
    const auto is_inside = [&](const reference::Nearest<double>& one) {
        return law_.features.inside == layout::kInsideWinding ? reference::inside_by_winding(mesh, probe)
                                                              : reference::inside_by_pseudonormal(mesh, one);
    };
    const bool inside = is_inside(found);
    if (inside ? fits(touch_of(probe, found.facet, {found.square, found.offset, found.feature})) : fits_free())
        return Verdict::within;
    const bool either = nearest <= slack;
    if (either && fits_free())
        return Verdict::on_edge;
    for (layout::uint triangle = 0; triangle < mesh.params.triangles; ++triangle) {
        const auto point = reference::nearest_on_triangle(mesh, triangle, probe);
        if (!(std::sqrt(point.square) <= nearest + slack))
            continue;
        const layout::uint facet = mesh.triangle_facets[triangle];
        const bool here = is_inside({triangle, facet, point.feature, point.offset, point.square});
        if (here || either ? fits(touch_of(probe, facet, point)) : false)
            return Verdict::on_edge;
        if (!here && fits_free())
            return Verdict::on_edge;
    }
    return Verdict::beyond;
}

bool MeshBound::parts(const Triple& computed, const Vector& probe, const Triple& exact) const {
    const double off = norm(computed[0] - exact[0], computed[1] - exact[1], computed[2] - exact[2]);
    // Few voxels are so far off that it is worth asking.
    if (off <= std::abs(law_.mesh.params.stiffness) * reach(probe))
        return false;
    const auto verdict = [&](const Triple& force) {
        Reading reading;
        reading.force = force;
        return judge(reading, probe, 1, layout::kChannelForce);
    };
    const Verdict own = verdict(computed);
    return own == Verdict::on_edge || (own == Verdict::within && verdict(exact) == Verdict::on_edge);
}

} // namespace forceshade
