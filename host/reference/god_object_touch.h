// L6: a triangle that a god-object touches, and the half-space that it leaves free.
#pragma once

#include "host/reference/god_object_planes.h"
#include "host/reference/mesh_cast.h"

namespace forceshade::reference {

/// A triangle near the proxy. Where the proxy is above its face, the face's plane holds it, a skin away. Where it is
/// beside it, the nearest edge or corner does, rounded by the skin; but not against moves that go over the face, for
/// which its plane does (else the proxy would creep into flat valleys by halves).
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
    Vector<T> proxy; /* where it was looked at from */
    layout::uint feature;
    bool faceless; /* its plane was tried from here and led nowhere */

    bool above_face() const noexcept { return feature == layout::kMeshFace; }
};

template <typename T> void begin_touch(const layout::MeshView<T>& mesh, layout::uint index, Touch<T>& touch) noexcept {
    touch.index = index;
    touch.faceless = false;
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

/// Beside the face, or too near its border to tell at a glance.
template <typename T> void look_closely(Touch<T>& touch) noexcept {
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
template <typename T> void look(Touch<T>& touch, const Vector<T>& proxy) noexcept {
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
        look_closely(touch);
}

enum class Hold { none, face, rounded };

/// Whether a move that descends towards the plane of a triangle, from beside it, reaches the plane on the inner side of
/// what is nearest: an edge, or the two edges of a corner.
template <typename T> bool lands_on_face(const Touch<T>& touch, const Vector<T>& way, T descent) noexcept {
    const bool corner = touch.feature >= layout::kMeshCorner;
    const layout::uint first = touch.feature - (corner ? layout::kMeshCorner : layout::kMeshEdge);
    for (layout::uint i = 0; i < (corner ? 2U : 1U); ++i) {
        const layout::uint edge = (first + 2 * i) % 3;
        // Inside at the time height / descent, without the division.
        if (!(touch.insides[edge] * descent + touch.height * dot(touch.inwards[edge], way) > T(0)))
            return false;
    }
    return true;
}

/// What of a touched triangle stands against a move.
template <typename T> Hold hold_of(const Touch<T>& touch, const Vector<T>& way) noexcept {
    if (touch.above_face())
        return Hold::face;
    if (touch.height >= Skin<T>::kPlane && !touch.faceless) {
        const T descent = -dot(touch.face, way);
        if (!(descent > Skin<T>::kRest))
            return Hold::none;
        if (lands_on_face(touch, way, descent))
            return Hold::face;
    }
    return touch.distance <= Skin<T>::kTangent ? Hold::rounded : Hold::none;
}

template <typename T> HalfSpace<T> half_space(const Touch<T>& touch, Hold hold, layout::uint source) noexcept {
    if (hold == Hold::face)
        return {touch.face, Skin<T>::kWidth - touch.height, source};
    return {touch.away, Skin<T>::kWidth - touch.distance, source};
}

/// When, and over which edge (3: none), a move along a triangle leaves it.
template <typename T> struct Release {
    T time;
    layout::uint edge;
};

/// Whether a whole move along the face's plane ends above the face.
template <typename T> bool stays_above_face(const Touch<T>& touch, const Vector<T>& way) noexcept {
    return touch.insides[0] + dot(touch.inwards[0], way) > T(0) &&
           touch.insides[1] + dot(touch.inwards[1], way) > T(0) && touch.insides[2] + dot(touch.inwards[2], way) > T(0);
}

/// A move along the face's plane leaves it a skin beyond an edge.
template <typename T> Release<T> release_of_face(const Touch<T>& touch, const Vector<T>& way, T until) noexcept {
    Release<T> release{until, 3};
    for (layout::uint i = 0; i < 3; ++i) {
        const T rate = dot(touch.inwards[i], way);
        if (!(touch.insides[i] + rate * release.time < T(0)) || !(rate < T(0)))
            continue;
        const T time = (touch.insides[i] + Skin<T>::kWidth * std::sqrt(touch.squares[i])) / -rate;
        if (time < release.time)
            release = {time > T(0) ? time : T(0), i};
    }
    return release;
}

/// A move along the plane of a rounded edge or corner leaves it a skin aside, or beyond the edge's ends.
template <typename T> Release<T> release_of_rounded(const Touch<T>& touch, const Vector<T>& way, T until) noexcept {
    Release<T> release{until, 3};
    const auto leaves_at = [&release](T time) {
        if (time < release.time)
            release.time = time > T(0) ? time : T(0);
    };
    if (touch.feature >= layout::kMeshCorner) {
        leaves_at(Skin<T>::kWidth / std::sqrt(dot(way, way)));
        return release;
    }
    const layout::uint i = touch.feature - layout::kMeshEdge;
    const T length = std::sqrt(touch.squares[i]);
    const T rate = dot(touch.edges[i], way) / length;
    const T along = dot(touch.edges[i], touch.proxy - touch.triangle.corners[i]) / length;
    const Vector<T> aside = way - (rate / length) * touch.edges[i];
    leaves_at(Skin<T>::kWidth / std::sqrt(dot(aside, aside)));
    if (rate > T(0))
        leaves_at((length + Skin<T>::kWidth - along) / rate);
    else if (rate < T(0))
        leaves_at((along + Skin<T>::kWidth) / -rate);
    return release;
}

} // namespace forceshade::reference
