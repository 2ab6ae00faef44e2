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
    Vector<T> face; /* unit normal, towards the proxy; 0 without area */
    T height;       /* above the face's plane, not below 0 */
    Vector<T> away; /* unit, from the nearest point to the proxy */
    T distance;
    Vector<T> proxy; /* where it was looked at from */
    layout::uint feature;
    bool faceless = false; /* its plane was tried from here and led nowhere */

    bool above_face() const noexcept { return feature == layout::kMeshFace; }
};

template <typename T> void look(Touch<T>& touch, const Vector<T>& proxy) noexcept {
    const TrianglePoint<T> nearest = nearest_on_triangle(proxy, touch.triangle);
    touch.proxy = proxy;
    touch.feature = nearest.feature;
    const T height = dot(touch.triangle.normal, proxy - touch.triangle.corners[0]);
    touch.face = height < T(0) ? -touch.triangle.normal : touch.triangle.normal;
    touch.height = std::abs(height);
    if (touch.above_face()) {
        touch.distance = touch.height;
        touch.away = touch.face;
        return;
    }
    touch.distance = std::sqrt(nearest.square);
    Vector<T> away = -nearest.offset;
    if (touch.feature < layout::kMeshCorner) {
        // Along the edge a move may be long, so the normal must be square to it to the last bit.
        const layout::uint i = touch.feature - layout::kMeshEdge;
        const Vector<T> edge = normalised(touch.triangle.corners[(i + 1) % 3] - touch.triangle.corners[i]);
        away -= dot(away, edge) * edge;
    }
    touch.away = normalised(away);
}

/// Inward, in the triangle's plane, square to edge i and as long as it.
template <typename T> Vector<T> inward_of(const Triangle<T>& triangle, layout::uint i) noexcept {
    return cross(triangle.normal, triangle.corners[(i + 1) % 3] - triangle.corners[i]);
}

enum class Hold { none, face, rounded };

/// Whether a move that descends towards the plane of a triangle, from beside it, reaches the plane on the inner side of
/// what is nearest: an edge, or the two edges of a corner.
template <typename T> bool lands_on_face(const Touch<T>& touch, const Vector<T>& way, T descent) noexcept {
    const bool corner = touch.feature >= layout::kMeshCorner;
    const layout::uint first = touch.feature - (corner ? layout::kMeshCorner : layout::kMeshEdge);
    for (layout::uint i = 0; i < (corner ? 2U : 1U); ++i) {
        const layout::uint edge = (first + 2 * i) % 3;
        const Vector<T> inward = inward_of(touch.triangle, edge);
        // Inside at the time height / descent, without the division.
        const T inside = dot(inward, touch.proxy - touch.triangle.corners[edge]);
        if (!(inside * descent + touch.height * dot(inward, way) > T(0)))
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

/// A move along the face's plane leaves it a skin beyond an edge.
template <typename T>
Release<T> release_of_face(const Touch<T>& touch, const Vector<T>& proxy, const Vector<T>& way, T until) noexcept {
    Release<T> release{until, 3};
    for (layout::uint i = 0; i < 3; ++i) {
        const Vector<T>& start = touch.triangle.corners[i];
        const Vector<T> edge = touch.triangle.corners[(i + 1) % 3] - start;
        const Vector<T> inward = cross(touch.triangle.normal, edge);
        const T rate = dot(inward, way);
        if (!(rate < T(0)))
            continue;
        const T inside = dot(inward, proxy - start);
        if (inside + rate * release.time >= T(0))
            continue;
        const T time = (inside + Skin<T>::kWidth * std::sqrt(dot(edge, edge))) / -rate;
        if (time < release.time)
            release = {time > T(0) ? time : T(0), i};
    }
    return release;
}

/// A move along the plane of a rounded edge or corner leaves it a skin aside, or beyond the edge's ends.
template <typename T>
Release<T> release_of_rounded(const Touch<T>& touch, const Vector<T>& proxy, const Vector<T>& way, T until) noexcept {
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
    const Vector<T>& start = touch.triangle.corners[i];
    const Vector<T> edge = touch.triangle.corners[(i + 1) % 3] - start;
    const T length = std::sqrt(dot(edge, edge));
    const T rate = dot(edge, way) / length;
    const T along = dot(edge, proxy - start) / length;
    const Vector<T> aside = way - (rate / length) * edge;
    leaves_at(Skin<T>::kWidth / std::sqrt(dot(aside, aside)));
    if (rate > T(0))
        leaves_at((length + Skin<T>::kWidth - along) / rate);
    else if (rate < T(0))
        leaves_at((along + Skin<T>::kWidth) / -rate);
    return release;
}

} // namespace forceshade::reference
