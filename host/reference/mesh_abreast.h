// Squared distances to triangles side by side, as many as a 16-byte vector holds: to the last bit what
// nearest_on_triangle() gives, without its branches, so that most triangles of a leaf are ruled out cheaply.
#pragma once

#include <cstdint>
#include <type_traits>

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

template <typename T> struct AbreastTypes;
template <> struct AbreastTypes<float> {
    using Real = float __attribute__((vector_size(16)));
    using Mask = std::int32_t __attribute__((vector_size(16)));
};
template <> struct AbreastTypes<double> {
    using Real = double __attribute__((vector_size(16)));
    using Mask = std::int64_t __attribute__((vector_size(16)));
};

template <typename T> constexpr layout::uint kTrianglesAbreast = 16 / sizeof(T);

/// Numbers of one kind, one for each of the triangles.
template <typename T> using Abreast = typename AbreastTypes<T>::Real;
template <typename T> using AbreastMask = typename AbreastTypes<T>::Mask;

template <typename T> struct VectorsAbreast { Abreast<T> x, y, z; };

template <typename T> VectorsAbreast<T> operator-(const VectorsAbreast<T>& u, const VectorsAbreast<T>& v) noexcept {
    return {u.x - v.x, u.y - v.y, u.z - v.z};
}

template <typename T> Abreast<T> dot(const VectorsAbreast<T>& u, const VectorsAbreast<T>& v) noexcept {
    return u.x * v.x + u.y * v.y + u.z * v.z;
}

template <typename T> VectorsAbreast<T> cross(const VectorsAbreast<T>& u, const VectorsAbreast<T>& v) noexcept {
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// What is known of one edge of each triangle.
template <typename T> struct EdgesAbreast {
    Abreast<T> square, length_square;
    AbreastMask<T> within, outside; /* nearest point between the ends; the probe's foot beyond the edge */
};

/// nearest_on_edge() and the side test; `start_square` and `end_square` are the products of the ends with themselves.
template <typename T>
EdgesAbreast<T> edges_abreast(const VectorsAbreast<T>& start, const VectorsAbreast<T>& end, Abreast<T> start_square,
                              Abreast<T> end_square, const VectorsAbreast<T>& edge,
                              const VectorsAbreast<T>& normal) noexcept {
    using Real = Abreast<T>;
    using Mask = AbreastMask<T>;
    const Real zero{};
    const Mask backwards =
        (edge.x < zero) | ((edge.x == zero) & ((edge.y < zero) | ((edge.y == zero) & (edge.z < zero))));
    const VectorsAbreast<T> from{backwards ? end.x : start.x, backwards ? end.y : start.y, backwards ? end.z : start.z};
    const VectorsAbreast<T> way{backwards ? -edge.x : edge.x, backwards ? -edge.y : edge.y,
                                backwards ? -edge.z : edge.z};
    const Real along = -dot<T>(from, way), length_square = dot<T>(edge, edge);
    const Real share = along / length_square; // not used where it is no number
    const VectorsAbreast<T> offset{from.x + share * way.x, from.y + share * way.y, from.z + share * way.z};
    const Mask after = along > zero, before = along < length_square;
    const Real from_square = backwards ? end_square : start_square, to_square = backwards ? start_square : end_square;
    const Real square = after ? (before ? dot<T>(offset, offset) : to_square) : from_square;
    return {square, length_square, after & before, ~(dot<T>(cross<T>(normal, edge), start) <= zero)};
}

/// The triangles first to first + kTrianglesAbreast - 1, each no further than `last`, which stands for those beyond.
template <typename T>
Abreast<T> squares_abreast(const layout::MeshView<T>& mesh, layout::uint first, layout::uint last,
                           const Vector<T>& probe) noexcept {
    using Real = Abreast<T>;
    using Mask = AbreastMask<T>;
    VectorsAbreast<T> corners[3], normal;
    for (layout::uint lane = 0; lane < kTrianglesAbreast<T>; ++lane) {
        const std::size_t triangle = first + lane < last ? first + lane : last;
        for (std::size_t i = 0; i < 3; ++i) {
            const T* corner = &mesh.vertices[3 * std::size_t(mesh.triangle_corners[3 * triangle + i])];
            corners[i].x[lane] = corner[0];
            corners[i].y[lane] = corner[1];
            corners[i].z[lane] = corner[2];
        }
        normal.x[lane] = mesh.triangle_normals[3 * triangle];
        normal.y[lane] = mesh.triangle_normals[3 * triangle + 1];
        normal.z[lane] = mesh.triangle_normals[3 * triangle + 2];
    }
    VectorsAbreast<T> offsets[3];
    Real corner_squares[3];
    for (std::size_t i = 0; i < 3; ++i) {
        offsets[i] = {corners[i].x - probe.x, corners[i].y - probe.y, corners[i].z - probe.z};
        corner_squares[i] = dot<T>(offsets[i], offsets[i]);
    }
    EdgesAbreast<T> edges[3];
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = i == 2 ? 0 : i + 1;
        edges[i] = edges_abreast<T>(offsets[i], offsets[next], corner_squares[i], corner_squares[next],
                                    corners[next] - corners[i], normal);
    }
    const Real zero{};
    Real nearest = edges[0].square, longest = edges[0].length_square;
    Mask within = edges[0].within;
    Mask inside = ~(edges[0].outside | edges[1].outside | edges[2].outside |
                    ((normal.x == zero) & (normal.y == zero) & (normal.z == zero)));
    for (std::size_t i = 1; i < 3; ++i) {
        nearest = edges[i].square < nearest ? edges[i].square : nearest;
        within = edges[i].length_square > longest ? edges[i].within : within;
        longest = edges[i].length_square > longest ? edges[i].length_square : longest;
    }
    inside &= within;
    const Real height = dot<T>(normal, offsets[0]);
    return inside ? height * height : nearest;
}

} // namespace forceshade::reference
