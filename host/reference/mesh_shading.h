// L7: the vertex normals of a facet, interpolated at a point of it, step for step as shaders/laws/mesh_shading.glsl.
#pragma once

#include <cmath>
#include <limits>

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

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
    return {offset, std::sqrt(dot(offset, offset)), vector_at(mesh.vertex_normals, vertex)};
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
    result.distance = std::sqrt(dot(result.offset, result.offset));
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
        const T across = dot(facet_normal, cross(start.offset, stop.offset)); // sine, likewise
        if (!(along > T(0)) && !(std::abs(across) > std::numeric_limits<T>::epsilon() * product))
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

} // namespace forceshade::reference
