// L6 static, L7 and L9 on a mesh: whether a probe is inside, the vertex normals interpolated at a point of a facet, and
// the force. From the interpolation on step for step as shaders/laws/mesh_contact.glsl.
#pragma once

#include <cmath>
#include <limits>
#include <numbers>

#include "host/reference/elementary.h"
#include "host/reference/mesh_nearest.h"
#include "host/reference/surfaces.h"
#include "shaders/shared/law.h"

namespace forceshade::reference {

// The generalized winding number (Jacobson et al. 2013): how often a surface, open ones too, goes round a point. Far
// parts through their moments (Barill et al. 2018), near triangles exactly (van Oosterom & Strackee 1983). Always in
// double, whatever the tables' precision, and on the host only: kernels receive bits.

/// `reach`: beyond this many times its radius a part is far. `error`: of the winding number then (tests: 4e-5 and 0.01
/// at worst). The rough one is enough nearly everywhere, since a closed surface goes round a point a whole number of
/// times.
struct WindingAccuracy {
    double reach, error;
};
constexpr WindingAccuracy kWindingFine{5, 1e-4}, kWindingRough{2, 0.1};

template <typename T> Vector<double> double_at(std::span<const T> table, std::size_t index) noexcept {
    return Vector<double>(vector_at(table, index));
}

/// The solid angle of a triangle seen from the origin, positive from inside; 2 pi at most. 0 at its own corners.
inline double solid_angle(const Vector<double>& a, const Vector<double>& b, const Vector<double>& c) noexcept {
    const double at_a = std::sqrt(dot(a, a)), at_b = std::sqrt(dot(b, b)), at_c = std::sqrt(dot(c, c));
    const double volume = dot(a, cross(b, c));
    const double spread = at_a * at_b * at_c + dot(a, b) * at_c + dot(b, c) * at_a + dot(c, a) * at_b;
    return 2 * std::atan2(volume, spread);
}

template <typename T>
double solid_angle(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<double>& probe) noexcept {
    const layout::uint* corners = &mesh.triangle_corners[3 * std::size_t(triangle)];
    return solid_angle(double_at(mesh.vertices, corners[0]) - probe, double_at(mesh.vertices, corners[1]) - probe,
                       double_at(mesh.vertices, corners[2]) - probe);
}

/// The solid angle of everything below a node, from `away` = its centre - probe, a long way off: the field of a dipole
/// layer to third order. Only symmetric parts count, since all derivatives of 1 / distance are symmetric.
inline double solid_angle(const layout::MeshMoment& moment, const Vector<double>& away, double square) noexcept {
    const double x = away.x, y = away.y, z = away.z;
    const double* q = moment.quadrupole;
    const double* o = moment.octupole;
    const double first = moment.dipole[0] * x + moment.dipole[1] * y + moment.dipole[2] * z;
    const double second = q[0] * x * x + q[1] * y * y + q[2] * z * z + 2 * (q[3] * x * y + q[4] * x * z + q[5] * y * z);
    const double second_trace = q[0] + q[1] + q[2];
    const double third = o[0] * x * x * x + o[1] * y * y * y + o[2] * z * z * z +
                         3 * (o[3] * x * x * y + o[4] * x * x * z + o[5] * x * y * y + o[6] * y * y * z +
                              o[7] * x * z * z + o[8] * y * z * z) +
                         6 * o[9] * x * y * z;
    const double third_trace = (o[0] + o[5] + o[7]) * x + (o[3] + o[1] + o[8]) * y + (o[4] + o[6] + o[2]) * z;
    const double sum = first + second_trace - 3 * second / square + (7.5 * third / square - 4.5 * third_trace) / square;
    return sum / (square * std::sqrt(square));
}

/// 1 inside a closed surface, 0 outside; needs mesh.moments. The probe is in the mesh's frame.
template <typename T>
double winding_number(const layout::MeshView<T>& mesh, const Vector<double>& probe,
                      WindingAccuracy accuracy = kWindingFine) noexcept {
    double sum = 0;
    const auto is_near = [&](layout::uint index) {
        const layout::MeshMoment& moment = mesh.moments[index];
        const Vector<double> away = Vector<double>(moment.centre[0], moment.centre[1], moment.centre[2]) - probe;
        const double square = dot(away, away), reach = accuracy.reach * moment.radius;
        if (!(square > reach * reach))
            return true;
        sum += solid_angle(moment, away, square);
        return false;
    };
    const auto add_run = [&](layout::uint triangle, layout::uint end) {
        for (; triangle < end; ++triangle)
            sum += solid_angle(mesh, triangle, probe);
    };
    visit_tree(
        mesh, is_near, [](const layout::MeshNode&, layout::uint) { return true; }, add_run);
    return sum / (4 * std::numbers::pi);
}

/// The winding number, just good enough to decide on which side of one half it and all within `change` of it are.
template <typename T>
double decisive_winding(const layout::MeshView<T>& mesh, const Vector<double>& probe, double change = 0) noexcept {
    const double rough = winding_number(mesh, probe, kWindingRough);
    return std::abs(rough - 0.5) > change + kWindingRough.error ? rough : winding_number(mesh, probe);
}

/// Whether the winding number is above one half.
template <typename T> bool inside_by_winding(const layout::MeshView<T>& mesh, const Vector<T>& probe) noexcept {
    return decisive_winding(mesh, Vector<double>(probe)) > 0.5;
}

/// How much the winding number can change within `radius` of a probe that has no triangle so near: 0 for a closed mesh,
/// otherwise by what a walk of that length sees of the rims, since |grad w| <= integral of |dl| / distance^2 / (4 pi)
/// along them (Biot and Savart). Stops adding at `enough`. Infinite if a rim is nearer than the radius.
template <typename T>
double winding_change(const layout::MeshView<T>& mesh, const Vector<double>& probe, double radius,
                      double enough = 1) noexcept {
    double change = 0;
    for (std::size_t i = 0; i < mesh.rims.size() && change < enough; i += 3) {
        const Vector<double> start = double_at(mesh.vertices, mesh.rims[i]) - probe;
        const Vector<double> edge = double_at(mesh.vertices, mesh.rims[i + 1]) - probe - start;
        const EdgePoint<double> point = nearest_on_edge(start, Vector<double>(start + edge), edge, dot(edge, edge));
        const double distance = std::sqrt(point.square);
        if (!(distance > radius))
            return std::numeric_limits<double>::infinity();
        const double nearer = distance - radius; // after the walk
        const double along = std::sqrt(dot(edge, edge)) / (nearer * nearer);
        change += mesh.rims[i + 2] * along * radius / (4 * std::numbers::pi);
    }
    return change;
}

// L7: the vertex normals of a facet, interpolated at a point of it.

/// A corner of a facet, seen from the point to be shaded.
template <typename T> struct MeshCorner {
    Vector<T> offset; /* 1: corner - point */
    T distance;       /* 1: |offset| */
    Vector<T> normal; /* 1: of the vertex */
};

template <typename T>
MeshCorner<T> corner_at(const layout::MeshView<T>& mesh, layout::uint corner, const Vector<T>& point) noexcept {
    const layout::uint vertex = mesh.facet_corners[corner];
    const Vector<T> offset = vector_at(mesh.vertices, vertex) - point;
    return {offset, sqrt(dot(offset, offset)), vector_at(mesh.vertex_normals, vertex)};
}

/// Morgenbesser & Srinivasan 1996: sum over i of x_i ((sum N) - N_i), x_i the distance to corner i; in one loop as
/// (sum x) (sum N) - sum of x_i N_i. Not of unit length.
template <typename T>
Vector<T> morgenbesser_normal(const layout::MeshView<T>& mesh, layout::uint facet, const Vector<T>& point) noexcept {
    T distances = T(0);
    Vector<T> normals(T(0)), weighted(T(0));
    for (layout::uint i = mesh.facet_begins[facet]; i < mesh.facet_begins[facet + 1]; ++i) {
        const MeshCorner<T> corner = corner_at(mesh, i, point);
        distances = distances + corner.distance;
        normals = normals + corner.normal;
        weighted = weighted + corner.distance * corner.normal;
    }
    return distances * normals - weighted;
}

template <typename T> T not_negative(T value) noexcept {
    return value > T(0) ? value : T(0);
}

/// Barycentric coordinates in a triangle: twice the areas opposite to its corners. Not of unit length.
template <typename T>
Vector<T> barycentric_normal(const layout::MeshView<T>& mesh, layout::uint facet, const Vector<T>& point) noexcept {
    const Vector<T> facet_normal = vector_at(mesh.facet_normals, facet);
    const layout::uint first = mesh.facet_begins[facet];
    const MeshCorner<T> a = corner_at(mesh, first, point);
    const MeshCorner<T> b = corner_at(mesh, first + 1, point);
    const MeshCorner<T> c = corner_at(mesh, first + 2, point);
    const T at_a = not_negative(dot(facet_normal, cross(b.offset, c.offset)));
    const T at_b = not_negative(dot(facet_normal, cross(c.offset, a.offset)));
    const T at_c = not_negative(dot(facet_normal, cross(a.offset, b.offset)));
    return at_a * a.normal + at_b * b.normal + at_c * c.normal;
}

/// A corner, projected into the facet's plane.
template <typename T>
MeshCorner<T> flat_corner_at(const layout::MeshView<T>& mesh, layout::uint corner, const Vector<T>& point,
                             const Vector<T>& facet_normal) noexcept {
    MeshCorner<T> result = corner_at(mesh, corner, point);
    result.offset = result.offset - dot(facet_normal, result.offset) * facet_normal;
    result.distance = sqrt(dot(result.offset, result.offset));
    return result;
}

/// Mean value coordinates (Floater 2003; Hormann & Floater 2006 for polygons that are not convex): corner i weighs
/// (t_i-1 + t_i) / r_i, with r the distances to the corners and t_i the tangent of half the angle under which edge i is
/// seen. Summed by edges. A point hardly off an edge (its tangent beyond 1 / epsilon) counts as on it, so no tangent is
/// large enough to overflow; inside a polygon the weights' sum is positive, and divides the sign of rounding out.
/// Not of unit length.
template <typename T>
Vector<T> mean_value_normal(const layout::MeshView<T>& mesh, layout::uint facet, const Vector<T>& point) noexcept {
    const Vector<T> facet_normal = vector_at(mesh.facet_normals, facet);
    const layout::uint begin = mesh.facet_begins[facet], end = mesh.facet_begins[facet + 1];
    Vector<T> sum(T(0));
    T weights = T(0);
    MeshCorner<T> start = flat_corner_at(mesh, end - 1, point, facet_normal);
    for (layout::uint i = begin; i < end; ++i) {
        const MeshCorner<T> stop = flat_corner_at(mesh, i, point, facet_normal);
        if (!(stop.distance > T(0)))
            return stop.normal;
        const T product = start.distance * stop.distance;
        const T along = dot(start.offset, stop.offset);                       // cosine of the angle, times product
        const T across = dot(facet_normal, cross(start.offset, stop.offset)); // sine, of the same
        if (!(along > T(0)) && !(abs(across) > std::numeric_limits<T>::epsilon() * product))
            return stop.distance * start.normal + start.distance * stop.normal;
        // Two forms of the tangent: each where it does not cancel.
        const T tangent = along > T(0) ? across / (product + along) : (product - along) / across;
        const T at_start = tangent / start.distance, at_stop = tangent / stop.distance;
        sum = sum + (at_start * start.normal + at_stop * stop.normal);
        weights = weights + (at_start + at_stop);
        start = stop;
    }
    return weights < T(0) ? -sum : sum;
}

/// L7: the unit direction that a shading (layout::kShadingMorgenbesser...) gives at a point of a facet, the facet's
/// normal for layout::kShadingNone; 0 where normals cancel or the facet has no area.
template <typename T>
Vector<T> shading_direction(const layout::MeshView<T>& mesh, layout::uint shading, layout::uint facet,
                            const Vector<T>& point) noexcept {
    switch (shading) {
    case layout::kShadingMorgenbesser:
        return normalised(morgenbesser_normal(mesh, facet, point));
    case layout::kShadingBarycentric:
        return normalised(barycentric_normal(mesh, facet, point));
    case layout::kShadingMeanValue:
    case layout::kShadingTwoPass:
        return normalised(mean_value_normal(mesh, facet, point));
    default:
        return vector_at(mesh.facet_normals, facet);
    }
}

// L6 static with L7 to L9: depth, force, proxy and facet of a probe in a mesh.

/// A point of the mesh's frame in m, from the scene's origin.
template <typename T> Vector<T> to_scene(const layout::MeshParams<T>& params, const Vector<T>& point) noexcept {
    return {point.x * params.scale + params.centre_x, point.y * params.scale + params.centre_y,
            point.z * params.scale + params.centre_z};
}

/// m: where a height map is read.
template <typename T> struct MapPlace { T x, y; };
template <typename T> MapPlace<T> map_place(const layout::MeshParams<T>& params, const Vector<T>& point) noexcept {
    return {point.x * params.scale + params.map_x, point.y * params.scale + params.map_y};
}

/// The part of a height map's gradient that lies in a facet's plane.
template <typename T> Vector<T> in_plane(Gradient<T> gradient, const Vector<T>& facet_normal) noexcept {
    const T across = gradient.x * facet_normal.x + gradient.y * facet_normal.y;
    return {gradient.x - across * facet_normal.x, gradient.y - across * facet_normal.y, -(across * facet_normal.z)};
}

/// Where a probe touches a mesh.
template <typename T> struct MeshTouch {
    layout::uint facet;
    Vector<T> offset; /* 1: proxy - probe */
    Vector<T> point;  /* 1: the proxy, in the mesh's frame */
    T distance;       /* 1: |offset| */
};

/// L7 and L9: the force before texture; as the unshaded one where the direction has no length or `two_pass` would pull.
/// With both, `two_pass` makes up for the direction that the map has tilted.
template <typename T>
Vector<T> shaded_force(const layout::Law<T>& law, const MeshTouch<T>& touch, const Vector<T>& unshaded) noexcept {
    const layout::Features& features = law.features;
    if (features.shading == layout::kShadingNone && features.map == layout::kMapNone)
        return unshaded;
    const Vector<T> facet_normal = vector_at(law.mesh.facet_normals, touch.facet);
    Vector<T> direction = shading_direction(law.mesh, features.shading, touch.facet, touch.point);
    if (!(dot(direction, direction) > T(0)))
        return unshaded;
    if (features.map != layout::kMapNone) {
        const MapPlace<T> place = map_place(law.mesh.params, touch.point);
        const Gradient<T> slope = gradient_at(features.map, law.params.map, law.map_gradients, place.x, place.y);
        direction = normalised(Vector<T>(direction - in_plane(slope, facet_normal)));
        if (!(dot(direction, direction) > T(0)))
            return unshaded;
    }
    T magnitude = law.mesh.params.stiffness * touch.distance;
    if (features.shading == layout::kShadingTwoPass) {
        const T lift = dot(direction, facet_normal);
        if (!(lift > T(0)))
            return unshaded;
        magnitude = magnitude / lift;
    }
    return {magnitude * direction.x, magnitude * direction.y, magnitude * direction.z};
}

/// The law of a probe in contact, for the static field and the god-object.
template <typename T> Contact<T> touching_contact(const layout::Law<T>& law, const MeshTouch<T>& touch) noexcept {
    const T stiffness = law.mesh.params.stiffness;
    Contact<T> contact;
    contact.depth = touch.distance * law.mesh.params.scale;
    contact.facet = touch.facet;
    contact.proxy = to_scene(law.mesh.params, touch.point);
    contact.unshaded = {stiffness * touch.offset.x, stiffness * touch.offset.y, stiffness * touch.offset.z};
    contact.force = shaded_force(law, touch, contact.unshaded);
    if (law.features.texture != layout::kMapNone) {
        const MapPlace<T> place = map_place(law.mesh.params, touch.point);
        const Vector<T> slope =
            in_plane(gradient_at(law.features.texture, law.params.texture, law.texture_gradients, place.x, place.y),
                     vector_at(law.mesh.facet_normals, touch.facet));
        const T pull = law.params.texture_stiffness * contact.depth;
        contact.force = contact.force - pull * slope;
        contact.unshaded = contact.unshaded - pull * slope;
    }
    return contact;
}

template <typename T> Contact<T> free_contact(const layout::Law<T>& law, const Vector<T>& probe) noexcept {
    return {T(0), Vector<T>(T(0)), Vector<T>(T(0)), to_scene(law.mesh.params, probe), layout::kNoFacet};
}

template <typename T>
bool is_inside(const layout::Law<T>& law, const Nearest<T>& found, const Vector<T>& probe) noexcept {
    return law.features.inside == layout::kInsideWinding ? inside_by_winding(law.mesh, probe)
                                                         : inside_by_pseudonormal(law.mesh, found);
}

/// The contact of a probe that is inside.
template <typename T>
Contact<T> contact_with(const layout::Law<T>& law, const Nearest<T>& found, const Vector<T>& probe) noexcept {
    return touching_contact(
        law, MeshTouch<T>{found.facet, found.offset, Vector<T>(probe + found.offset), sqrt(found.square)});
}

/// m, from the scene's origin, to the mesh's frame.
template <typename T> Vector<T> to_mesh_frame(const layout::MeshParams<T>& params, const Vector<T>& place) noexcept {
    return {(place.x - params.centre_x) / params.scale, (place.y - params.centre_y) / params.scale,
            (place.z - params.centre_z) / params.scale};
}

/// L6 static: the probe (in the mesh's frame) is pulled to the nearest point of the surface that it is inside of.
/// `hint` as for nearest(); receives the nearest triangle.
template <typename T>
Contact<T> mesh_contact(const layout::Law<T>& law, const Vector<T>& probe, layout::uint& hint) noexcept {
    const Nearest<T> found = nearest(law.mesh, probe, hint);
    hint = found.triangle;
    return is_inside(law, found, probe) ? contact_with(law, found, probe) : free_contact(law, probe);
}

template <typename T> Contact<T> mesh_contact(const layout::Law<T>& law, const Vector<T>& probe) noexcept {
    layout::uint hint = 0;
    return mesh_contact(law, probe, hint);
}

} // namespace forceshade::reference
