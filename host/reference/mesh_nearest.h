// L6 static: the point of a mesh nearest to a probe, through the tree; the same result as a loop over all triangles.
#pragma once

#include <cmath>
#include <cstring>
#include <limits>
#include <type_traits>

#include "host/reference/mesh_abreast.h"
#include "host/reference/mesh_triangle.h"

namespace forceshade::reference {

/// The nearest point of a mesh, in its frame.
template <typename T> struct Nearest {
    layout::uint triangle, facet;
    layout::uint feature; /* layout::kMeshFace, kMeshEdge + i, kMeshCorner + i */
    Vector<T> offset;     /* 1: nearest point - probe */
    T square;             /* 1: |offset|^2, as compared */
};

/// Nodes of a path from the root to a leaf, at most: the builder sees to it. A path leaves three siblings a node.
constexpr layout::uint kMeshTreeDepth = 48;
constexpr layout::uint kMeshStack = 3 * kMeshTreeDepth + 1;

/// What rounding to T can make of a distance from a probe none of whose coordinates is beyond `largest`, twice over.
/// With u half an epsilon and L = 1 + largest, to first order:
/// - an edge: coordinates differ from exact ones by u (|S| + 2|e| + |r|) <= 6 sqrt(3) u L, the root of the square by
///   1.5 sqrt(3) u L more: 13 u L;
/// - a face: the sides of the edges are told to 14 u L, so the foot is within twice that of the triangle (the longest
///   edge bounds it lengthwise, whatever the shape), and the height is good to 14 u L: 42 u L;
/// - a box: three differences, squares and sums, 18 u L.
/// Together below 64 u L = 32 epsilons.
template <typename T> T prune_slack(T largest) noexcept {
    return T(64) * std::numeric_limits<T>::epsilon() * (T(1) + largest);
}

template <typename T> T largest_coordinate(const Vector<T>& v) noexcept {
    const T x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
    const T xy = x > y ? x : y;
    return xy > z ? xy : z;
}

template <typename T>
TrianglePoint<T> nearest_on_triangle(const layout::MeshView<T>& mesh, layout::uint triangle,
                                     const Vector<T>& probe) noexcept {
    const std::size_t first = 3 * std::size_t(triangle);
    return nearest_on_triangle(probe, vector_at(mesh.vertices, mesh.triangle_corners[first]),
                               vector_at(mesh.vertices, mesh.triangle_corners[first + 1]),
                               vector_at(mesh.vertices, mesh.triangle_corners[first + 2]),
                               vector_at(mesh.triangle_normals, triangle));
}

/// Keeps the least of (square, facet, triangle): the order in which triangles come does not matter.
template <typename T>
bool keep_nearer(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<T>& probe,
                 Nearest<T>& best) noexcept {
    const TrianglePoint<T> point = nearest_on_triangle(mesh, triangle, probe);
    if (point.square > best.square)
        return false;
    const layout::uint facet = mesh.triangle_facets[triangle];
    const bool first = facet < best.facet || (facet == best.facet && triangle < best.triangle);
    if (!(point.square < best.square || first))
        return false;
    best = {triangle, facet, point.feature, point.offset, point.square};
    return true;
}

/// Likewise for triangles first to last; most are ruled out without a look at where their nearest points lie.
template <typename T>
bool keep_nearest_of_run(const layout::MeshView<T>& mesh, layout::uint first, layout::uint last, const Vector<T>& probe,
                         Nearest<T>& best) noexcept {
    bool kept = false;
    for (layout::uint triangle = first; triangle <= last; triangle += kTrianglesAbreast<T>) {
        const Abreast<T> squares = squares_abreast(mesh, triangle, last, probe);
        for (layout::uint lane = 0; lane < kTrianglesAbreast<T> && triangle + lane <= last; ++lane)
            if (squares[lane] <= best.square && keep_nearer(mesh, triangle + lane, probe, best))
                kept = true;
    }
    return kept;
}

/// How far a probe is beyond the bounds of four boxes along one axis; 0 within them.
template <typename Cull> Abreast<Cull> beyond(const float* low, const float* high, Cull at) noexcept {
    Abreast<Cull> below, above;
    for (layout::uint lane = 0; lane < kTrianglesAbreast<Cull>; ++lane) {
        below[lane] = Cull(low[lane]);
        above[lane] = Cull(high[lane]);
    }
    below = below - at;
    above = at - above;
    const Abreast<Cull> further = below > above ? below : above;
    const Abreast<Cull> zero{};
    return further > zero ? further : zero;
}

/// Squared distances from a probe to the four boxes of a node, good to Cull's rounding.
template <typename Cull>
void box_squares(const layout::MeshNode& node, Cull x, Cull y, Cull z,
                 Cull (&squares)[layout::kMeshChildren]) noexcept {
    for (layout::uint i = 0; i < layout::kMeshChildren; i += kTrianglesAbreast<Cull>) {
        const Abreast<Cull> dx = beyond(node.low_x + i, node.high_x + i, x);
        const Abreast<Cull> dy = beyond(node.low_y + i, node.high_y + i, y);
        const Abreast<Cull> dz = beyond(node.low_z + i, node.high_z + i, z);
        const Abreast<Cull> square = dx * dx + dy * dy + dz * dz;
        std::memcpy(squares + i, &square, sizeof square);
    }
}

template <typename Cull> struct MeshVisit {
    Cull square; /* 1: of the distance to the child's box */
    layout::uint child;
};

/// Pushes the children that may hold something nearer, the nearest last. Without branches: which children those are
/// cannot be foreseen.
template <typename Cull>
void push_children(const layout::MeshNode& node, const Cull (&squares)[layout::kMeshChildren], Cull limit,
                   MeshVisit<Cull>* stack, layout::uint& height) noexcept {
    layout::uint nearest = height, top = height;
    Cull least = std::numeric_limits<Cull>::infinity();
    for (layout::uint i = 0; i < layout::kMeshChildren; ++i) {
        stack[top] = {squares[i], node.child[i]};
        const bool pushed = (squares[i] <= limit) & (node.child[i] != layout::kMeshNoChild);
        const bool nearer = pushed & (squares[i] < least);
        nearest = nearer ? top : nearest;
        least = nearer ? squares[i] : least;
        top += pushed ? 1 : 0;
    }
    if (top == height)
        return;
    const MeshVisit<Cull> last = stack[top - 1];
    stack[top - 1] = stack[nearest];
    stack[nearest] = last;
    height = top;
}

/// Boxes are judged in Cull: single precision is enough near the mesh, and faster.
template <typename Cull, typename T>
Nearest<T> nearest_from(const layout::MeshView<T>& mesh, const Vector<T>& probe, Nearest<T> best) noexcept {
    const Cull x = static_cast<Cull>(probe.x), y = static_cast<Cull>(probe.y), z = static_cast<Cull>(probe.z);
    const Cull slack = prune_slack(static_cast<Cull>(largest_coordinate(probe)));
    const auto limit_of = [slack](T square) {
        const Cull reach = static_cast<Cull>(std::sqrt(square)) + slack;
        return reach * reach;
    };
    Cull limit = limit_of(best.square);
    MeshVisit<Cull> stack[kMeshStack];
    layout::uint height = 0;
    stack[height++] = {Cull(0), 0};
    while (height > 0) {
        const MeshVisit<Cull> visit = stack[--height];
        if (visit.square > limit)
            continue;
        if ((visit.child & layout::kMeshLeaf) == 0) {
            const layout::MeshNode& node = mesh.nodes[visit.child];
            Cull squares[layout::kMeshChildren];
            box_squares(node, x, y, z, squares);
            push_children(node, squares, limit, stack, height);
            continue;
        }
        const layout::uint run = visit.child & ~layout::kMeshLeaf;
        const layout::uint first = run / layout::kMeshLeafTriangles;
        if (keep_nearest_of_run(mesh, first, first + run % layout::kMeshLeafTriangles, probe, best))
            limit = limit_of(best.square);
    }
    return best;
}

/// L6: the least (square, facet, triangle) over all triangles of the mesh. The probe is in the mesh's frame. `hint` is
/// any triangle: a near one makes it faster, and the result is the same.
template <typename T>
Nearest<T> nearest(const layout::MeshView<T>& mesh, const Vector<T>& probe, layout::uint hint = 0) noexcept {
    constexpr T kSingleReach = T(64); // further out single precision would hardly prune
    const TrianglePoint<T> point = nearest_on_triangle(mesh, hint, probe);
    const Nearest<T> start{hint, mesh.triangle_facets[hint], point.feature, point.offset, point.square};
    if (std::is_same_v<T, float> || largest_coordinate(probe) < kSingleReach)
        return nearest_from<float>(mesh, probe, start);
    return nearest_from<T>(mesh, probe, start);
}

/// L6: whether the probe is on the inner side of the feature nearest to it: the pseudonormal of the face, the edge or
/// the corner, weighted by angle, points away from it.
template <typename T> bool inside_by_pseudonormal(const layout::MeshView<T>& mesh, const Nearest<T>& nearest) noexcept {
    const Vector<T> own = vector_at(mesh.triangle_normals, nearest.triangle);
    if (nearest.feature == layout::kMeshFace)
        return dot(nearest.offset, own) > T(0);
    const std::size_t first = 3 * std::size_t(nearest.triangle);
    if (nearest.feature >= layout::kMeshCorner) {
        const layout::uint vertex = mesh.triangle_corners[first + (nearest.feature - layout::kMeshCorner)];
        return dot(nearest.offset, vector_at(mesh.vertex_pseudonormals, vertex)) > T(0);
    }
    const layout::uint across = mesh.triangle_neighbours[first + (nearest.feature - layout::kMeshEdge)];
    if (across == layout::kMeshBorder)
        return dot(nearest.offset, own) > T(0);
    if ((across & layout::kMeshManyBit) != 0)
        return dot(nearest.offset, vector_at(mesh.edge_pseudonormals, across & ~layout::kMeshManyBit)) > T(0);
    const Vector<T> other = vector_at(mesh.triangle_normals, across);
    return dot(nearest.offset, Vector<T>{own.x + other.x, own.y + other.y, own.z + other.z}) > T(0);
}

} // namespace forceshade::reference
