// L6: the half-spaces that constrain a god-object: the projection onto those that up to three planes allow (least
// squares by Lagrange multipliers), and the half-space that a touched triangle leaves free.
#pragma once

#include <cmath>
#include <limits>

#include "host/reference/mesh_cast.h"
#include "shaders/shared/law.h"

namespace forceshade::reference {

/// normal . v >= slack.
template <typename T> struct HalfSpace {
    Vector<T> normal; /* unit */
    T slack;
    layout::uint source; /* whose it is */
};

/// The vector nearest to a wish among those that the half-spaces allow, and the half-spaces active there.
template <typename T> struct Projection {
    Vector<T> vector;
    HalfSpace<T> active[3];
    T multipliers[3]; /* vector - wish = sum multipliers * normals, none below 0 but for rounding */
    layout::uint count = 0;
};

template <typename T> Projection<T> onto_plane(const Vector<T>& wish, const HalfSpace<T>& one) noexcept {
    Projection<T> result;
    const T multiplier = one.slack - dot(one.normal, wish);
    result.vector = wish + multiplier * one.normal;
    // Once more for what rounding leaves of a long wish.
    result.vector += (one.slack - dot(one.normal, result.vector)) * one.normal;
    result.active[0] = one;
    result.multipliers[0] = multiplier;
    result.count = 1;
    return result;
}

/// Onto the line where two planes meet; count stays 0 if they are parallel.
template <typename T>
Projection<T> onto_line(const Vector<T>& wish, const HalfSpace<T>& one, const HalfSpace<T>& other) noexcept {
    constexpr T kParallel = std::numeric_limits<T>::epsilon() * std::numeric_limits<T>::epsilon() * T(256);
    Projection<T> result;
    const Vector<T> line = cross(one.normal, other.normal);
    const T square = dot(line, line);
    if (!(square > kParallel))
        return result;
    const Vector<T> to_one = cross(other.normal, line) / square;
    const Vector<T> to_other = cross(line, one.normal) / square;
    result.vector = (dot(line, wish) / square) * line + one.slack * to_one + other.slack * to_other;
    const T miss_one = one.slack - dot(one.normal, result.vector);
    const T miss_other = other.slack - dot(other.normal, result.vector);
    result.vector += miss_one * to_one + miss_other * to_other;
    const Vector<T> shift = result.vector - wish;
    result.active[0] = one;
    result.active[1] = other;
    result.multipliers[0] = dot(shift, to_one);
    result.multipliers[1] = dot(shift, to_other);
    result.count = 2;
    return result;
}

/// The corner where three planes meet; count stays 0 if they have none.
template <typename T>
Projection<T> onto_corner(const Vector<T>& wish, const HalfSpace<T>& a, const HalfSpace<T>& b,
                          const HalfSpace<T>& c) noexcept {
    constexpr T kFlat = std::numeric_limits<T>::epsilon() * T(16);
    Projection<T> result;
    const Vector<T> bc = cross(b.normal, c.normal), ca = cross(c.normal, a.normal), ab = cross(a.normal, b.normal);
    const T volume = dot(a.normal, bc);
    if (!(std::abs(volume) > kFlat))
        return result;
    const auto meeting = [&](T one, T two, T three) { return (one * bc + two * ca + three * ab) / volume; };
    result.vector = meeting(a.slack, b.slack, c.slack);
    result.vector += meeting(a.slack - dot(a.normal, result.vector), b.slack - dot(b.normal, result.vector),
                             c.slack - dot(c.normal, result.vector));
    const Vector<T> shift = result.vector - wish;
    const HalfSpace<T>* spaces[3] = {&a, &b, &c};
    const Vector<T> duals[3] = {bc, ca, ab};
    for (layout::uint i = 0; i < 3; ++i) {
        result.active[i] = *spaces[i];
        result.multipliers[i] = dot(shift, duals[i]) / volume;
    }
    result.count = 3;
    return result;
}

/// What rounding of a projection explains. A push off a plane is as exact as the wish is long, a height above a plane
/// only as the vector is: of a long wish into a plane little may be left.
template <typename T> struct Tolerance {
    T push;
    T least, most; /* of a height */

    T height(const Vector<T>& vector) const noexcept {
        const T rounding = least + T(8) * std::numeric_limits<T>::epsilon() * largest_coordinate(vector);
        return rounding < most ? rounding : most;
    }
};

/// The same for heights as for pushes.
template <typename T> Tolerance<T> one_tolerance(T tolerance) noexcept {
    return {tolerance, tolerance, tolerance};
}

/// Whether a projection pushes only off its planes and stays within the others.
template <typename T>
bool is_nearest(const Projection<T>& result, const HalfSpace<T>* others, layout::uint count,
                const Tolerance<T>& tolerance) noexcept {
    if (result.count == 0)
        return false;
    for (layout::uint i = 0; i < result.count; ++i)
        if (!(result.multipliers[i] >= -tolerance.push))
            return false;
    const T below = tolerance.height(result.vector);
    for (layout::uint i = 0; i < count; ++i)
        if (!(dot(others[i].normal, result.vector) >= others[i].slack - below))
            return false;
    return true;
}

/// Adds a half-space that `now` violates. False, and `now` unchanged, if no vector satisfies them all.
template <typename T>
[[nodiscard]] bool add_half_space(const Vector<T>& wish, const HalfSpace<T>& added, const Tolerance<T>& tolerance,
                                  Projection<T>& now) noexcept {
    const HalfSpace<T>* active = now.active;
    Projection<T> next = onto_plane(wish, added);
    bool found = is_nearest(next, active, now.count, tolerance);
    for (layout::uint i = 0; !found && i < now.count; ++i) {
        next = onto_line(wish, added, active[i]);
        found = is_nearest(next, active, now.count, tolerance);
    }
    for (layout::uint i = 0; !found && i < now.count; ++i)
        for (layout::uint j = i + 1; !found && j < now.count; ++j) {
            next = onto_corner(wish, added, active[i], active[j]);
            found = is_nearest(next, active, now.count, tolerance);
        }
    if (found)
        now = next;
    return found;
}

/// Projects a wish onto half-spaces that `worst(vector, half_space)` gives one at a time: it returns whether the vector
/// violates one by more than the tolerance, and which. Each one added takes the vector further from the wish, so this
/// ends. False if no vector was found.
template <typename T, typename Worst>
[[nodiscard]] bool project(const Vector<T>& wish, const Tolerance<T>& tolerance, Projection<T>& result,
                           Worst&& worst) noexcept {
    constexpr int kRounds = 64;
    result.count = 0;
    result.vector = wish;
    HalfSpace<T> violated;
    for (int i = 0; i < kRounds; ++i) {
        if (!worst(result.vector, violated))
            return true;
        if (!add_half_space(wish, violated, tolerance, result))
            return false;
    }
    return false;
}

/// A triangle near the proxy. Where the proxy is above its face, the face's plane constrains it, a skin away. Where it
/// is outside of it, the nearest edge or corner does, rounded by the skin; but not against moves that go over the face,
/// for which its plane does (else the proxy would creep into flat valleys by halves).
template <typename T> struct Touch {
    layout::uint index; /* of the triangle */
    Triangle<T> triangle;
    Vector<T> edges[3];   /* from corner i to the next */
    Vector<T> inwards[3]; /* in the triangle's plane, square to its edge and as long */
    T squares[3];         /* of the edges' lengths */
    Vector<T> face;       /* unit normal, towards the proxy; 0 without area */
    T height;             /* above the face's plane, not below 0 */
    Vector<T> away;       /* unit, from the nearest point to the proxy */
    T distance;
    T insides[3];    /* of the proxy from each edge, times its length; below 0 beyond it */
    Vector<T> proxy; /* where it was tested from */
    layout::uint feature;
    bool face_tried; /* its plane was tried from here without success */

    bool above_face() const noexcept { return feature == layout::kMeshFace; }
};

template <typename T> void begin_touch(const layout::MeshView<T>& mesh, layout::uint index, Touch<T>& touch) noexcept {
    touch.index = index;
    touch.face_tried = false;
    touch.triangle = triangle_at(mesh, index);
    const Vector<T>&a = touch.triangle.corners[0], &b = touch.triangle.corners[1], &c = touch.triangle.corners[2];
    const Vector<T>& normal = touch.triangle.normal;
    const auto begin_edge = [&](layout::uint i, const Vector<T>& edge) {
        touch.edges[i] = edge;
        touch.inwards[i] = cross(normal, edge);
        touch.squares[i] = dot(edge, edge);
    };
    begin_edge(0, b - a);
    begin_edge(1, c - b);
    begin_edge(2, a - c);
}

/// Outside of the face, or too near its border for the quick test.
template <typename T> void update_touch_beside_face(Touch<T>& touch) noexcept {
    const TrianglePoint<T> nearest = nearest_on_triangle(touch.proxy, touch.triangle);
    touch.feature = nearest.feature;
    if (touch.above_face())
        return;
    touch.distance = std::sqrt(nearest.square);
    Vector<T> away = -nearest.offset;
    if (touch.feature < layout::kMeshCorner) {
        // Along the edge a move may be long, so the normal must be square to it to the last bit.
        const Vector<T> edge = normalised(touch.edges[touch.feature - layout::kMeshEdge]);
        away -= dot(away, edge) * edge;
    }
    touch.away = normalised(away);
}

/// Finds out how the proxy stands to a triangle.
template <typename T> void update_touch(Touch<T>& touch, const Vector<T>& proxy) noexcept {
    constexpr T kClear = Skin<T>::kWidth * T(0.125) * Skin<T>::kWidth * T(0.125);
    touch.proxy = proxy;
    const T height = dot(touch.triangle.normal, proxy - touch.triangle.corners[0]);
    touch.face = height < T(0) ? -touch.triangle.normal : touch.triangle.normal;
    touch.height = std::abs(height);
    touch.distance = touch.height;
    touch.away = touch.face;
    touch.feature = layout::kMeshFace;
    bool clear = true;
    for (layout::uint i = 0; i < 3; ++i) {
        const T inside = dot(touch.inwards[i], proxy - touch.triangle.corners[i]);
        touch.insides[i] = inside;
        clear = clear && inside > T(0) && inside * inside > kClear * touch.squares[i];
    }
    if (!clear)
        update_touch_beside_face(touch);
}

/// What a hash of the walk takes in of a touch. Sums of products, so that one does not wait for another.
template <typename T> layout::uint digest_of(const Touch<T>& touch) noexcept {
    const layout::uint stands = touch.index << 4 | touch.feature << 1 | (touch.face_tried ? 1U : 0U);
    return stands * 2654435761U + folded(touch.height) * 2246822519U + folded(touch.distance) * 3266489917U +
           folded(touch.insides[0]) * 668265263U + folded(touch.insides[1]) * 374761393U +
           folded(touch.insides[2]) * 2869860233U;
}

enum class Constraint { none, face, rounded };

/// Whether a move that descends towards the plane of a triangle, from outside of its face, reaches the plane on the
/// inner side of what is nearest: an edge, or the two edges of a corner.
template <typename T> bool lands_on_face(const Touch<T>& touch, const Vector<T>& displacement, T descent) noexcept {
    const bool corner = touch.feature >= layout::kMeshCorner;
    const layout::uint first = touch.feature - (corner ? layout::kMeshCorner : layout::kMeshEdge);
    for (layout::uint i = 0; i < (corner ? 2U : 1U); ++i) {
        const layout::uint edge = (first + 2 * i) % 3;
        // Inside at the time height / descent, without the division.
        if (!(touch.insides[edge] * descent + touch.height * dot(touch.inwards[edge], displacement) > T(0)))
            return false;
    }
    return true;
}

/// The part of a touched triangle that constrains a move.
template <typename T> Constraint constraint_of(const Touch<T>& touch, const Vector<T>& displacement) noexcept {
    if (touch.above_face())
        return Constraint::face;
    if (touch.height >= Skin<T>::kPlane && !touch.face_tried) {
        const T descent = -dot(touch.face, displacement);
        if (!(descent > Skin<T>::kRest))
            return Constraint::none;
        if (lands_on_face(touch, displacement, descent))
            return Constraint::face;
    }
    return touch.distance <= Skin<T>::kTangent ? Constraint::rounded : Constraint::none;
}

template <typename T>
HalfSpace<T> half_space(const Touch<T>& touch, Constraint constraint, layout::uint source) noexcept {
    if (constraint == Constraint::face)
        return {touch.face, Skin<T>::kWidth - touch.height, source};
    return {touch.away, Skin<T>::kWidth - touch.distance, source};
}

/// When, and over which edge (3: none), a move along a triangle leaves it.
template <typename T> struct Release {
    T time;
    layout::uint edge;
};

/// Whether a whole move along the face's plane ends above the face.
template <typename T> bool stays_above_face(const Touch<T>& touch, const Vector<T>& displacement) noexcept {
    return touch.insides[0] + dot(touch.inwards[0], displacement) > T(0) &&
           touch.insides[1] + dot(touch.inwards[1], displacement) > T(0) &&
           touch.insides[2] + dot(touch.inwards[2], displacement) > T(0);
}

/// A move along the face's plane leaves it a skin beyond an edge.
template <typename T>
Release<T> release_of_face(const Touch<T>& touch, const Vector<T>& displacement, T until) noexcept {
    Release<T> release{until, 3};
    for (layout::uint i = 0; i < 3; ++i) {
        const T rate = dot(touch.inwards[i], displacement);
        if (!(touch.insides[i] + rate * release.time < T(0)) || !(rate < T(0)))
            continue;
        const T time = (touch.insides[i] + Skin<T>::kWidth * std::sqrt(touch.squares[i])) / -rate;
        if (time < release.time)
            release = {time > T(0) ? time : T(0), i};
    }
    return release;
}

/// A move along the plane of a rounded edge or corner leaves it a skin aside, or beyond the edge's ends.
template <typename T>
Release<T> release_of_rounded(const Touch<T>& touch, const Vector<T>& displacement, T until) noexcept {
    Release<T> release{until, 3};
    const auto leaves_at = [&release](T time) {
        if (time < release.time)
            release.time = time > T(0) ? time : T(0);
    };
    if (touch.feature >= layout::kMeshCorner) {
        leaves_at(Skin<T>::kWidth / std::sqrt(dot(displacement, displacement)));
        return release;
    }
    const layout::uint i = touch.feature - layout::kMeshEdge;
    const T length = std::sqrt(touch.squares[i]);
    const T rate = dot(touch.edges[i], displacement) / length;
    const T along = dot(touch.edges[i], touch.proxy - touch.triangle.corners[i]) / length;
    const Vector<T> aside = displacement - (rate / length) * touch.edges[i];
    leaves_at(Skin<T>::kWidth / std::sqrt(dot(aside, aside)));
    if (rate > T(0))
        leaves_at((length + Skin<T>::kWidth - along) / rate);
    else if (rate < T(0))
        leaves_at((along + Skin<T>::kWidth) / -rate);
    return release;
}

} // namespace forceshade::reference
