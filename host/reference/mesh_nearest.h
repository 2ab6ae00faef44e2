// L6: the point of a triangle, and of a mesh through its tree, that is nearest to a probe, step for step as
// shaders/laws/mesh_triangle.glsl; and whether the probe is inside.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>

#include "host/reference/elementary.h"
#include "shaders/shared/law.h"

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

/// Whether the first component of an edge that is not 0 is below 0. Both triangles of an edge walk it in the same
/// direction, so that they agree to the last bit and the tie goes to the lower facet.
template <typename T> [[gnu::always_inline]] inline bool runs_backwards(const Vector<T>& edge) noexcept {
    return edge.x < T(0) || (edge.x == T(0) && (edge.y < T(0) || (edge.y == T(0) && edge.z < T(0))));
}

/// `start` and `end` relative to the probe, `edge` the exact-rounded difference of the corners, `length_square` its
/// product with itself.
template <typename T>
EdgePoint<T> nearest_on_edge(const Vector<T>& start, const Vector<T>& end, const Vector<T>& edge,
                             T length_square) noexcept {
    const bool backwards = runs_backwards(edge);
    const Vector<T> from = backwards ? end : start;
    const Vector<T> to = backwards ? start : end;
    const Vector<T> direction = backwards ? -edge : edge;
    const T along = -dot(from, direction);
    if (!(along > T(0)))
        return {dot(from, from), from, backwards ? EdgePlace::end : EdgePlace::start};
    if (!(along < length_square))
        return {dot(to, to), to, backwards ? EdgePlace::start : EdgePlace::end};
    const T share = along / length_square;
    const Vector<T> offset{from.x + share * direction.x, from.y + share * direction.y, from.z + share * direction.z};
    return {dot(offset, offset), offset, EdgePlace::within};
}

/// L6: the nearest point of the triangle a, b, c with this unit normal (0 if it has none). The face counts if the
/// probe's foot is on the inner side of every edge and, along the longest edge (the first of equals), strictly
/// between its ends: else rounding would extend the tip of a sliver. Otherwise the nearest edge does, the first of
/// equals. Right for slivers and for triangles without area, since edges are clamped.
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

template <typename T> struct Triangle {
    Vector<T> corners[3];
    Vector<T> normal; /* unit, 0 without area */
};

template <typename T>
[[gnu::always_inline]] inline Triangle<T> triangle_at(const layout::MeshView<T>& mesh, layout::uint triangle) noexcept {
    const std::size_t first = 3 * std::size_t(triangle);
    return {{vector_at(mesh.vertices, mesh.triangle_corners[first]),
             vector_at(mesh.vertices, mesh.triangle_corners[first + 1]),
             vector_at(mesh.vertices, mesh.triangle_corners[first + 2])},
            vector_at(mesh.triangle_normals, triangle)};
}

template <typename T>
TrianglePoint<T> nearest_on_triangle(const Vector<T>& point, const Triangle<T>& triangle) noexcept {
    return nearest_on_triangle(point, triangle.corners[0], triangle.corners[1], triangle.corners[2], triangle.normal);
}

// Squared distances to triangles side by side, as many as a 16-byte vector holds: to the last bit what
// nearest_on_triangle() gives, without its branches, so that most triangles of a leaf are ruled out cheaply.

template <typename T> struct LaneTypes;
template <> struct LaneTypes<float> {
    using Real = float __attribute__((vector_size(16)));
    using Mask = std::int32_t __attribute__((vector_size(16)));
};
template <> struct LaneTypes<double> {
    using Real = double __attribute__((vector_size(16)));
    using Mask = std::int64_t __attribute__((vector_size(16)));
};

template <typename T> constexpr layout::uint kLanes = 16 / sizeof(T);

/// Numbers of one kind, one for each of the triangles.
template <typename T> using Lanes = typename LaneTypes<T>::Real;
template <typename T> using LaneMask = typename LaneTypes<T>::Mask;

template <typename T> struct VectorLanes { Lanes<T> x, y, z; };

template <typename T> VectorLanes<T> operator-(const VectorLanes<T>& u, const VectorLanes<T>& v) noexcept {
    return {u.x - v.x, u.y - v.y, u.z - v.z};
}

template <typename T> Lanes<T> dot(const VectorLanes<T>& u, const VectorLanes<T>& v) noexcept {
    return u.x * v.x + u.y * v.y + u.z * v.z;
}

template <typename T> VectorLanes<T> cross(const VectorLanes<T>& u, const VectorLanes<T>& v) noexcept {
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// One edge of each triangle.
template <typename T> struct EdgeLanes {
    Lanes<T> square, length_square;
    LaneMask<T> within, outside; /* nearest point between the ends; the probe's foot beyond the edge */
};

/// nearest_on_edge() and the side test; `start_square` and `end_square` are the products of the ends with themselves.
template <typename T>
EdgeLanes<T> edge_lanes(const VectorLanes<T>& start, const VectorLanes<T>& end, Lanes<T> start_square,
                        Lanes<T> end_square, const VectorLanes<T>& edge, const VectorLanes<T>& normal) noexcept {
    using Real = Lanes<T>;
    using Mask = LaneMask<T>;
    const Real zero{};
    const Mask backwards =
        (edge.x < zero) | ((edge.x == zero) & ((edge.y < zero) | ((edge.y == zero) & (edge.z < zero))));
    const VectorLanes<T> from{backwards ? end.x : start.x, backwards ? end.y : start.y, backwards ? end.z : start.z};
    const VectorLanes<T> direction{backwards ? -edge.x : edge.x, backwards ? -edge.y : edge.y,
                                   backwards ? -edge.z : edge.z};
    const Real along = -dot<T>(from, direction), length_square = dot<T>(edge, edge);
    const Real share = along / length_square; // not used if not finite
    const VectorLanes<T> offset{from.x + share * direction.x, from.y + share * direction.y,
                                from.z + share * direction.z};
    const Mask after = along > zero, before = along < length_square;
    const Real from_square = backwards ? end_square : start_square, to_square = backwards ? start_square : end_square;
    const Real square = after ? (before ? dot<T>(offset, offset) : to_square) : from_square;
    return {square, length_square, after & before, ~(dot<T>(cross<T>(normal, edge), start) <= zero)};
}

template <typename T> struct TriangleLanes { VectorLanes<T> corners[3], normal; };

/// The triangles triangle(lane), one a lane.
template <typename T, typename Index>
[[gnu::always_inline]] inline TriangleLanes<T> triangle_lanes(const layout::MeshView<T>& mesh,
                                                              const Index& triangle) noexcept {
    TriangleLanes<T> lanes;
    for (layout::uint lane = 0; lane < kLanes<T>; ++lane) {
        const std::size_t first = 3 * std::size_t(triangle(lane));
        for (std::size_t i = 0; i < 3; ++i) {
            const T* corner = &mesh.vertices[3 * std::size_t(mesh.triangle_corners[first + i])];
            lanes.corners[i].x[lane] = corner[0];
            lanes.corners[i].y[lane] = corner[1];
            lanes.corners[i].z[lane] = corner[2];
        }
        lanes.normal.x[lane] = mesh.triangle_normals[first];
        lanes.normal.y[lane] = mesh.triangle_normals[first + 1];
        lanes.normal.z[lane] = mesh.triangle_normals[first + 2];
    }
    return lanes;
}

/// The triangles first to first + kLanes - 1, each no further than `last`, which stands for those beyond.
template <typename T>
Lanes<T> square_lanes(const layout::MeshView<T>& mesh, layout::uint first, layout::uint last,
                      const Vector<T>& probe) noexcept {
    using Real = Lanes<T>;
    using Mask = LaneMask<T>;
    const auto [corners, normal] =
        triangle_lanes(mesh, [&](layout::uint lane) { return first + lane < last ? first + lane : last; });
    VectorLanes<T> offsets[3];
    Real corner_squares[3];
    for (std::size_t i = 0; i < 3; ++i) {
        offsets[i] = {corners[i].x - probe.x, corners[i].y - probe.y, corners[i].z - probe.z};
        corner_squares[i] = dot<T>(offsets[i], offsets[i]);
    }
    EdgeLanes<T> edges[3];
    for (std::size_t i = 0; i < 3; ++i) {
        const std::size_t next = i == 2 ? 0 : i + 1;
        edges[i] = edge_lanes<T>(offsets[i], offsets[next], corner_squares[i], corner_squares[next],
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

// L6 static: the point of a mesh nearest to a probe, through the tree; the same result as a loop over all triangles.

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

[[gnu::always_inline]] inline layout::uint leaf_begin(layout::uint child) noexcept {
    return (child & ~layout::kMeshLeaf) / layout::kMeshLeafTriangles;
}

/// Calls visit(first, end) for the run of triangles that a leaf is.
template <typename Visit> void visit_leaf(layout::uint child, Visit&& visit) noexcept {
    const layout::uint first = leaf_begin(child);
    visit(first, first + child % layout::kMeshLeafTriangles + 1);
}

/// Calls visit(first, end) for the runs of triangles below the nodes that enters(index) lets in, and there below the
/// children that meets(node, i). Of several children the last one's come first, but for a node's own runs.
template <typename T, typename Enters, typename Meets, typename Visit>
void visit_tree(const layout::MeshView<T>& mesh, const Enters& enters, const Meets& meets, Visit&& visit) {
    layout::uint stack[kMeshStack];
    layout::uint height = 0;
    stack[height++] = 0;
    while (height > 0) {
        const layout::uint index = stack[--height];
        if (!enters(index))
            continue;
        const layout::MeshNode& node = mesh.nodes[index];
        for (layout::uint i = 0; i < layout::kMeshChildren; ++i) {
            if (node.child[i] == layout::kMeshNoChild || !meets(node, i))
                continue;
            if ((node.child[i] & layout::kMeshLeaf) == 0)
                stack[height++] = node.child[i];
            else
                visit_leaf(node.child[i], visit);
        }
    }
}

/// What rounding to T can make of a distance from a probe none of whose coordinates is beyond `largest`, twice over.
/// With u half an epsilon and L = 1 + largest, to first order:
/// - an edge: coordinates differ from exact ones by u (|S| + 2|e| + |r|) <= 6 sqrt(3) u L, the root of the square by
///   1.5 sqrt(3) u L more: 13 u L;
/// - a face: the sides of the edges are good to 14 u L, so the foot is within twice that of the triangle (the longest
///   edge bounds it lengthwise, whatever the shape), and the height is good to 14 u L: 42 u L;
/// - a box: three differences, squares and sums, 18 u L; a slab: a product and a difference, 16 u L.
/// Together below 64 u L = 32 epsilons.
template <typename T> T prune_slack(T largest) noexcept {
    return T(64) * std::numeric_limits<T>::epsilon() * (T(1) + largest);
}

/// Which of two triangles comes first among equals.
template <typename T>
bool comes_before(const layout::MeshView<T>& mesh, layout::uint one, layout::uint other) noexcept {
    const layout::uint first = mesh.triangle_facets[one], second = mesh.triangle_facets[other];
    return first < second || (first == second && one < other);
}

/// Keeps the least of (square, facet, triangle): the order in which triangles come does not matter.
template <typename T>
bool keep_nearer(const layout::MeshView<T>& mesh, layout::uint triangle, const Vector<T>& probe,
                 Nearest<T>& best) noexcept {
    const TrianglePoint<T> point = nearest_on_triangle(probe, triangle_at(mesh, triangle));
    if (point.square > best.square)
        return false;
    const layout::uint facet = mesh.triangle_facets[triangle];
    const bool first = facet < best.facet || (facet == best.facet && triangle < best.triangle);
    if (!(point.square < best.square || first))
        return false;
    best = {triangle, facet, point.feature, point.offset, point.square};
    return true;
}

/// The same for triangles first to last; most are ruled out without a look at where their nearest points lie.
template <typename T>
bool keep_nearest_of_run(const layout::MeshView<T>& mesh, layout::uint first, layout::uint last, const Vector<T>& probe,
                         Nearest<T>& best) noexcept {
    bool kept = false;
    for (layout::uint triangle = first; triangle <= last; triangle += kLanes<T>) {
        const Lanes<T> squares = square_lanes(mesh, triangle, last, probe);
        for (layout::uint lane = 0; lane < kLanes<T> && triangle + lane <= last; ++lane)
            if (squares[lane] <= best.square && keep_nearer(mesh, triangle + lane, probe, best))
                kept = true;
    }
    return kept;
}

/// How far a place is beyond bounds; 0 within them.
template <typename Cull>
[[gnu::always_inline]] inline Lanes<Cull> beyond(Lanes<Cull> low, Lanes<Cull> high, Lanes<Cull> at) noexcept {
    const Lanes<Cull> below = low - at, above = at - high;
    const Lanes<Cull> further = below > above ? below : above;
    const Lanes<Cull> zero{};
    return further > zero ? further : zero;
}

/// Some of the numbers of a node's children.
template <typename Cull> [[gnu::always_inline]] inline Lanes<Cull> lanes_of(const float* values) noexcept {
    Lanes<Cull> result{};
    if constexpr (std::is_same_v<Cull, float>)
        std::memcpy(&result, values, sizeof result);
    else
        for (layout::uint lane = 0; lane < kLanes<Cull>; ++lane)
            result[lane] = Cull(values[lane]);
    return result;
}

/// Lower bounds of the squared distances from a probe to the triangles below a node's four children: by their boxes and
/// slabs, good to Cull's rounding.
template <typename Cull>
[[gnu::always_inline]] inline void child_squares(const layout::MeshNode& node, const layout::MeshSlabs& slabs,
                                                 Cull at_x, Cull at_y, Cull at_z,
                                                 Cull (&squares)[layout::kMeshChildren]) noexcept {
    using Real = Lanes<Cull>;
    const Real zero{}, x = zero + at_x, y = zero + at_y, z = zero + at_z;
    for (layout::uint i = 0; i < layout::kMeshChildren; i += kLanes<Cull>) {
        const auto of = [i](const float* values) { return lanes_of<Cull>(values + i); };
        const Real dx = beyond<Cull>(of(node.low_x), of(node.high_x), x);
        const Real dy = beyond<Cull>(of(node.low_y), of(node.high_y), y);
        const Real dz = beyond<Cull>(of(node.low_z), of(node.high_z), z);
        const Real along = of(slabs.normal_x) * x + of(slabs.normal_y) * y + of(slabs.normal_z) * z;
        const Real across = beyond<Cull>(of(slabs.low), of(slabs.high), along);
        const Real box = dx * dx + dy * dy + dz * dz, slab = across * across;
        const Real square = slab > box ? slab : box;
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
            child_squares(node, mesh.slabs[visit.child], x, y, z, squares);
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
    const TrianglePoint<T> point = nearest_on_triangle(probe, triangle_at(mesh, hint));
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
