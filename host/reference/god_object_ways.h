// L6: the ways that lead from a corner or an edge of a mesh over its faces and along its edges.
#pragma once

#include "host/reference/god_object_planes.h"
#include "host/reference/mesh_around.h"

namespace forceshade::reference {

/// A way over a triangle's face, or along its edge.
template <typename T> struct Way {
    Vector<T> direction{T(0)};                   /* unit */
    T gain = std::numeric_limits<T>::infinity(); /* towards the probe, a length of way */
    layout::uint triangle = 0;
    layout::uint edge = 3; /* 3: over the face */
};

/// How near a corner a proxy may be kept off it by folds there narrower than the skin.
template <typename T> constexpr T kFold = Skin<T>::kWidth* T(Skin<T>::kDouble ? 4096 : 32);

/// Where ways begin: a corner of the mesh, or a place on or near its surface. What is within reach of it is at it.
template <typename T> struct Crossing {
    Vector<T> place;
    T reach;
    Vector<T> out; /* unit, away from the surface, on the proxy's side; 0 if not known */
    bool corner;
    layout::uint vertex; /* of a corner */
};

/// The nearest corner of the mesh within reach, if there is one; seen from the front or the back of the triangles
/// around.
template <typename T>
Crossing<T> corner_at(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Vector<T>& place, T reach,
                      bool front) noexcept {
    Crossing<T> crossing{place, Skin<T>::kWidth * T(0.5), Vector<T>(T(0)), false, 0};
    T nearest = reach * reach;
    visit_near(mesh, around, Move<T>{place, Vector<T>(T(0)), T(0)}, [&](layout::uint index) {
        for (layout::uint i = 0; i < 3; ++i) {
            const layout::uint other = mesh.triangle_corners[3 * std::size_t(index) + i];
            const Vector<T> off = vector_at(mesh.vertices, other) - place;
            const T square = dot(off, off);
            if (!(square < nearest) && (square > nearest || !crossing.corner || other >= crossing.vertex))
                continue;
            nearest = square;
            crossing.vertex = other;
            crossing.corner = true;
        }
    });
    if (!crossing.corner)
        return crossing;
    crossing.place = vector_at(mesh.vertices, crossing.vertex);
    const Vector<T> normal = normalised(vector_at(mesh.vertex_pseudonormals, crossing.vertex));
    crossing.out = front ? normal : -normal;
    return crossing;
}

/// The steepest of a triangle's ways from a crossing on it that gain less than `below`, if one gains more than `best`.
template <typename T> struct WaySearch {
    const layout::MeshView<T>& mesh;
    const Crossing<T>& from;
    const Vector<T> pull; /* to the probe */
    T below;
    Way<T> best;
    bool found = false;

    void offer(layout::uint index) noexcept {
        const Triangle<T> triangle = triangle_at(mesh, index);
        if (!has_corner(index) && !(nearest_on_triangle(from.place, triangle).square <= from.reach * from.reach))
            return;
        offer_face(triangle, index);
        for (layout::uint i = 0; i < 3; ++i)
            offer_edge(triangle, index, i);
    }

private:
    bool has_corner(layout::uint index) const noexcept {
        const layout::uint* corners = &mesh.triangle_corners[3 * std::size_t(index)];
        return from.corner && (corners[0] == from.vertex || corners[1] == from.vertex || corners[2] == from.vertex);
    }

    /// Over the face, away from the edges that the crossing is on.
    void offer_face(const Triangle<T>& triangle, layout::uint index) noexcept {
        const Vector<T> way = pull - dot(pull, triangle.normal) * triangle.normal;
        for (layout::uint i = 0; i < 3; ++i) {
            const Vector<T> edge = triangle.corners[(i + 1) % 3] - triangle.corners[i];
            const Vector<T> inward = cross(triangle.normal, edge);
            const T inside = dot(inward, from.place - triangle.corners[i]);
            const T most = from.reach * std::sqrt(dot(edge, edge));
            if (inside <= most && !(dot(inward, way) > T(0)))
                return;
        }
        offer_way(normalised(way), index, 3);
    }

    /// Along an edge that the crossing is on, to the end that is nearer to the probe.
    void offer_edge(const Triangle<T>& triangle, layout::uint index, layout::uint i) noexcept {
        const Vector<T>& start = triangle.corners[i];
        const Vector<T>& end = triangle.corners[(i + 1) % 3];
        const T rate = dot(end - start, pull);
        // Both of the edge's triangles walk it the same way.
        if (!(rate * rate >= best.gain * best.gain * dot(end - start, end - start) * T(0.99)))
            return;
        const Vector<T> way = normalised(Vector<T>(end - start));
        const T along = dot(way, from.place - start);
        const Vector<T> off = from.place - start - along * way;
        if (!(dot(off, off) <= from.reach * from.reach))
            return;
        const bool forwards = dot(way, pull) > T(0);
        const Vector<T>& goal = forwards ? end : start;
        if (dot(goal - from.place, goal - from.place) > T(16) * from.reach * from.reach)
            offer_way(forwards ? way : -way, index, i);
    }

    void offer_way(const Vector<T>& direction, layout::uint index, layout::uint edge) noexcept {
        const T gain = dot(direction, pull);
        if (!(gain < below) || !(gain >= best.gain))
            return;
        if (found && gain == best.gain) {
            const layout::uint facet = mesh.triangle_facets[index], other = mesh.triangle_facets[best.triangle];
            if (facet > other || (facet == other && index >= best.triangle))
                return;
        }
        best = {direction, gain, index, edge};
        found = true;
    }
};

/// The steepest way that is less steep than the last one, of the lowest facet and triangle among equals. False if none
/// gains as much as `least`.
template <typename T>
bool next_way(const layout::MeshView<T>& mesh, Neighbourhood<T>& around, const Crossing<T>& from,
              const Vector<T>& probe, T least, Way<T>& way) noexcept {
    WaySearch<T> search{mesh, from, probe - from.place, way.gain, {Vector<T>(T(0)), least, 0, 3}};
    visit_near(mesh, around, Move<T>{from.place, Vector<T>(T(0)), T(0)},
               [&](layout::uint index) { search.offer(index); });
    if (search.found)
        way = search.best;
    return search.found;
}

/// The place so far along a way, a skin off the surface there on the side of `normal`, which is square to the way's
/// triangle.
template <typename T>
Vector<T> place_along(const layout::MeshView<T>& mesh, const Crossing<T>& from, const Way<T>& way, T length,
                      const Vector<T>& normal) noexcept {
    const std::size_t first = 3 * std::size_t(way.triangle);
    const Vector<T> there = from.place + length * way.direction;
    const Vector<T> corner = vector_at(mesh.vertices, mesh.triangle_corners[first + way.edge % 3]);
    const HalfSpace<T> one{normal, Skin<T>::kWidth - dot(normal, there - corner), 0};
    const Vector<T> still(T(0));
    const layout::uint across = way.edge < 3 ? mesh.triangle_neighbours[first + way.edge] : layout::kMeshBorder;
    if (across == layout::kMeshBorder || (across & layout::kMeshManyBit) != 0)
        return there + onto_plane(still, one).vector;
    // The edge's other triangle, whose corner off the edge tells which way it folds.
    const layout::uint begin = mesh.triangle_corners[first + way.edge];
    const layout::uint end = mesh.triangle_corners[first + (way.edge + 1) % 3];
    layout::uint i = 0;
    while (i < 2 && (mesh.triangle_corners[3 * std::size_t(across) + i] == begin ||
                     mesh.triangle_corners[3 * std::size_t(across) + i] == end))
        ++i;
    const bool turned = mesh.triangle_corners[3 * std::size_t(across) + (i + 1) % 3] == begin;
    const bool reversed = dot(normal, vector_at(mesh.triangle_normals, way.triangle)) < T(0);
    const Vector<T> plain = vector_at(mesh.triangle_normals, across);
    const Vector<T> beyond = turned == reversed ? plain : -plain;
    const Vector<T> apex = vector_at(mesh.vertices, mesh.triangle_corners[3 * std::size_t(across) + i]);
    if (dot(normal, apex - corner) > T(0)) {
        const HalfSpace<T> other{beyond, Skin<T>::kWidth - dot(beyond, there - corner), 1};
        const Projection<T> valley = onto_line(still, one, other);
        return there + (valley.count > 0 ? valley : onto_plane(still, one)).vector;
    }
    return there + Skin<T>::kWidth * normalised(Vector<T>(normal + beyond));
}

} // namespace forceshade::reference
