// L6: the point of one triangle nearest to a probe, step for step as shaders/laws/mesh_triangle.glsl. Right for slivers
// and for triangles without area, since edges are clamped and the face is not believed beyond its longest edge.
#pragma once

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

/// From the probe to the nearest point of a triangle.
template <typename T> struct TrianglePoint {
    T square;             /* 1: |offset|^2, as compared */
    Vector<T> offset;     /* 1: nearest point - probe */
    layout::uint feature; /* layout::kMeshFace, kMeshEdge + i, kMeshCorner + i */
};

enum class EdgePlace : layout::uint { within, start, end };

/// From the probe to the nearest point of an edge.
template <typename T> struct EdgePoint {
    T square;
    Vector<T> offset;
    EdgePlace place;
};

/// Whether the first component of an edge that is not 0 is below 0. Both triangles of an edge walk it the same way, so
/// that they agree to the last bit and the tie goes to the lower facet.
template <typename T> bool walked_backwards(const Vector<T>& edge) noexcept {
    return edge.x < T(0) || (edge.x == T(0) && (edge.y < T(0) || (edge.y == T(0) && edge.z < T(0))));
}

/// `start` and `end` relative to the probe, `edge` the exact-rounded difference of the corners, `length_square` its
/// product with itself.
template <typename T>
EdgePoint<T> nearest_on_edge(const Vector<T>& start, const Vector<T>& end, const Vector<T>& edge,
                             T length_square) noexcept {
    const bool backwards = walked_backwards(edge);
    const Vector<T> from = backwards ? end : start;
    const Vector<T> to = backwards ? start : end;
    const Vector<T> way = backwards ? -edge : edge;
    const T along = -dot(from, way);
    if (!(along > T(0)))
        return {dot(from, from), from, backwards ? EdgePlace::end : EdgePlace::start};
    if (!(along < length_square))
        return {dot(to, to), to, backwards ? EdgePlace::start : EdgePlace::end};
    const T share = along / length_square;
    const Vector<T> offset{from.x + share * way.x, from.y + share * way.y, from.z + share * way.z};
    return {dot(offset, offset), offset, EdgePlace::within};
}

/// L6: the nearest point of the triangle a, b, c with this unit normal (0 if it has none). The face counts if the
/// probe's foot is on the inner side of every edge and, along the longest edge (the first of equals), strictly
/// between its ends: else rounding would extend the tip of a sliver. Otherwise the nearest edge does, the first of
/// equals.
template <typename T>
TrianglePoint<T> nearest_on_triangle(const Vector<T>& probe, const Vector<T>& a, const Vector<T>& b, const Vector<T>& c,
                                     const Vector<T>& normal) noexcept {
    const Vector<T> corners[3] = {a - probe, b - probe, c - probe};
    const Vector<T> edges[3] = {b - a, c - b, a - c};
    EdgePoint<T> points[3];
    layout::uint nearest = 0, longest = 0;
    T longest_square = T(0);
    bool inside = !(normal.x == T(0) && normal.y == T(0) && normal.z == T(0));
    for (layout::uint i = 0; i < 3; ++i) {
        const Vector<T>& start = corners[i];
        const T length_square = dot(edges[i], edges[i]);
        points[i] = nearest_on_edge(start, corners[(i + 1) % 3], edges[i], length_square);
        if (points[i].square < points[nearest].square)
            nearest = i;
        if (length_square > longest_square) {
            longest = i;
            longest_square = length_square;
        }
        if (!(dot(cross(normal, edges[i]), start) <= T(0)))
            inside = false;
    }
    if (inside && points[longest].place == EdgePlace::within) {
        const T height = dot(normal, corners[0]);
        return {height * height, {height * normal.x, height * normal.y, height * normal.z}, layout::kMeshFace};
    }
    const EdgePoint<T>& point = points[nearest];
    if (point.place == EdgePlace::within)
        return {point.square, point.offset, layout::kMeshEdge + nearest};
    const layout::uint corner = point.place == EdgePlace::start ? nearest : (nearest + 1) % 3;
    return {point.square, point.offset, layout::kMeshCorner + corner};
}

} // namespace forceshade::reference
