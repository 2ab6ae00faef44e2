// L6: straight moves of a god-object: how closely one approaches a triangle, and where it enters the mesh's region.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <type_traits>

#include "host/reference/mesh_nearest.h"

namespace forceshade::reference {

/// The skin that keeps a god-object off every triangle, in the mesh's frame, where no coordinate is beyond 1: far above
/// what rounding does to a height, far below any perceptible length. The distance from a triangle is convex along a
/// line, so a move that keeps to a half-space off the triangle, or at whose nearest the distance is positive, does not
/// cross it.
template <typename T> struct Skin {
    static constexpr bool kDouble = std::is_same_v<T, double>;
    static constexpr T kWidth = kDouble ? T(0x1p-40) : T(0x1p-15);
    static constexpr T kImpact = kWidth * T(0.875);     /* a move ends where it comes this close */
    static constexpr T kPlane = kWidth * T(0.90625);    /* above this a plane alone keeps a move from an impact */
    static constexpr T kCulled = kWidth * T(0.9375);    /* beyond this a height needs no closer look */
    static constexpr T kTangent = kWidth * T(1.015625); /* up to here a rounded edge's own plane constrains the proxy */
    static constexpr T kNear = kWidth * T(2);           /* what is further is forgotten */
    static constexpr T kCorner = kWidth * T(8);         /* what is this near may share a corner */
    static constexpr T kPlace = std::numeric_limits<T>::epsilon() * T(32); /* what rounding makes of a place */
    static constexpr T kRest = kWidth * T(0.015625);                       /* moves shorter than this are none */
    static constexpr T kFlush = kRest * T(0.25); /* what is no higher above a plane than this is not above it */
};

/// from + t * move for t in [0, until].
template <typename T> struct Move {
    Vector<T> from, displacement;
    T until;

    Vector<T> at(T t) const noexcept {
        return {from.x + t * displacement.x, from.y + t * displacement.y, from.z + t * displacement.z};
    }
};

/// The part of a move that is within kCulled of the triangle's plane; empty if begin > end.
template <typename T> struct Stretch { T begin, end; };

template <typename T> Stretch<T> stretch_near_plane(const Move<T>& move, T height, T rate) noexcept {
    constexpr T kReach = Skin<T>::kCulled;
    const T last = height + move.until * rate;
    if ((height > kReach && last > kReach) || (height < -kReach && last < -kReach))
        return {T(1), T(0)};
    T begin = T(0), end = move.until;
    if (height > kReach)
        begin = (kReach - height) / rate;
    else if (height < -kReach)
        begin = (-kReach - height) / rate;
    if (last > kReach)
        end = (kReach - height) / rate;
    else if (last < -kReach)
        end = (-kReach - height) / rate;
    return {begin > T(0) ? begin : T(0), end < move.until ? end : move.until};
}

/// Whether all of a move is further than kCulled from the triangle's plane, on one side.
template <typename T> bool is_off_plane(const Triangle<T>& triangle, const Move<T>& move) noexcept {
    constexpr T kFar = Skin<T>::kCulled;
    const T begin = dot(triangle.normal, move.from - triangle.corners[0]);
    const T end = begin + move.until * dot(triangle.normal, move.displacement);
    return (begin > kFar && end > kFar) || (begin < -kFar && end < -kFar);
}

/// Whether both ends of a stretch are further than the skin outside the same edge.
template <typename T>
bool beyond_an_edge(const Triangle<T>& triangle, const Vector<T>& begin, const Vector<T>& end) noexcept {
    constexpr T kReach = Skin<T>::kWidth;
    for (int i = 0; i < 3; ++i) {
        const Vector<T>& start = triangle.corners[i];
        const Vector<T> edge = triangle.corners[(i + 1) % 3] - start;
        const Vector<T> inward = cross(triangle.normal, edge);
        const T one = dot(inward, begin - start);
        const T other = dot(inward, end - start);
        const T nearer = one > other ? one : other;
        if (nearer < T(0) && nearer * nearer > kReach * kReach * dot(edge, edge))
            return true;
    }
    return false;
}

/// beyond_an_edge() of the part of a move that is near each plane, for triangles side by side.
template <typename T> LaneMask<T> beyond_an_edge(const TriangleLanes<T>& triangles, const Move<T>& move) noexcept {
    using Real = Lanes<T>;
    const Real zero{}, reach = zero + Skin<T>::kCulled, until = zero + move.until;
    const VectorLanes<T> from{zero + move.from.x, zero + move.from.y, zero + move.from.z};
    const VectorLanes<T> displacement{zero + move.displacement.x, zero + move.displacement.y,
                                      zero + move.displacement.z};
    const auto at = [&](Real t) {
        return VectorLanes<T>{from.x + t * displacement.x, from.y + t * displacement.y, from.z + t * displacement.z};
    };
    const Real height = dot<T>(triangles.normal, from - triangles.corners[0]);
    const Real rate = dot<T>(triangles.normal, displacement), last = height + until * rate;
    const Real above = (reach - height) / rate, below = (-reach - height) / rate; // not used if not finite
    const VectorLanes<T> begin = at(height > reach ? above : height < -reach ? below : zero);
    const VectorLanes<T> end = at(last > reach ? above : last < -reach ? below : until);
    LaneMask<T> beyond{};
    for (std::size_t i = 0; i < 3; ++i) {
        const VectorLanes<T>& corner = triangles.corners[i];
        const VectorLanes<T> edge = triangles.corners[i == 2 ? 0 : i + 1] - corner;
        const VectorLanes<T> inward = cross<T>(triangles.normal, edge);
        const Real one = dot<T>(inward, begin - corner), other = dot<T>(inward, end - corner);
        const Real nearer = one > other ? one : other;
        beyond |= (nearer < zero) & (nearer * nearer > Skin<T>::kWidth * Skin<T>::kWidth * dot<T>(edge, edge));
    }
    return beyond;
}

/// The part of an offset that is square to an edge, to the last bit: along the edge a move may be long.
template <typename T> Vector<T> square_to(const Vector<T>& edge, const Vector<T>& offset) noexcept {
    return offset - (dot(offset, edge) / dot(edge, edge)) * edge;
}

/// Whether rounding may take one of two points this far apart for the other, seen from this distance: which is nearer
/// shows in the distance alone, to which their offset adds by its square.
template <typename T> bool is_one_place(const Vector<T>& apart, T distance) noexcept {
    return dot(apart, apart) <= Skin<T>::kPlace * (Skin<T>::kPlace + T(2) * distance);
}

/// The rate of approach, times the distance, to an edge that begins at a corner, if a move that is at the corner goes
/// on over it and this is more than `approach`.
template <typename T>
void approach_edge(const Vector<T>& edge, const Vector<T>& to_corner, T distance, const Vector<T>& displacement,
                   T& approach) noexcept {
    const Vector<T> offset = square_to(edge, to_corner);
    const T rate = dot(offset, displacement);
    if (dot(edge, displacement) > T(0) && rate > approach && is_one_place(Vector<T>(to_corner - offset), distance))
        approach = rate;
}

/// How fast a move from `place` approaches a triangle, times the distance. Where rounding may have taken a corner for
/// an edge, or either for the face, the feature over which the move goes on counts as well, and the fastest of them: a
/// slow approach along the triangle must not be taken for a retreat.
template <typename T>
T approach_of(const TrianglePoint<T>& nearest, const Triangle<T>& triangle, const Vector<T>& place, T distance,
              const Vector<T>& displacement) noexcept {
    if (nearest.feature == layout::kMeshFace)
        return dot(nearest.offset, displacement);
    Vector<T> edges[3];
    for (layout::uint i = 0; i < 3; ++i)
        edges[i] = triangle.corners[(i + 1) % 3] - triangle.corners[i];
    const auto leads_inwards = [&](layout::uint edge) {
        return dot(cross(triangle.normal, edges[edge]), displacement) > T(0);
    };
    const bool on_edge = nearest.feature < layout::kMeshCorner;
    const layout::uint local = nearest.feature - (on_edge ? layout::kMeshEdge : layout::kMeshCorner);
    T approach = dot(on_edge ? square_to(edges[local], nearest.offset) : nearest.offset, displacement);
    bool inwards = !on_edge || leads_inwards(local);
    for (layout::uint i = 0; i < 3; ++i) {
        const layout::uint before = (i + 2) % 3;
        const Vector<T> to_corner = triangle.corners[i] - place;
        const bool at_corner =
            on_edge ? (i == local || before == local) && is_one_place(Vector<T>(to_corner - nearest.offset), distance)
                    : i == local;
        if (!at_corner)
            continue;
        approach_edge(edges[i], to_corner, distance, displacement, approach);
        approach_edge(Vector<T>(-edges[before]), to_corner, distance, displacement, approach);
        inwards = inwards && leads_inwards(i) && leads_inwards(before);
    }
    const T height = dot(triangle.normal, nearest.offset);
    const T rate = height * dot(triangle.normal, displacement);
    const bool over_face = inwards && is_one_place(Vector<T>(nearest.offset - height * triangle.normal), distance);
    return over_face && rate > approach ? rate : approach;
}

/// The time within the move at which it comes within kImpact of the triangle, approaching; above `move.until` if it
/// never does. The distance is convex along the move: Newton's steps from the left never overshoot.
template <typename T> T impact_time(const Triangle<T>& triangle, const Move<T>& move) noexcept {
    constexpr int kSteps = 40;
    const T never = move.until + T(1);
    // Of a triangle without area, whose normal is 0, the whole move.
    const T height = dot(triangle.normal, move.from - triangle.corners[0]);
    const Stretch<T> stretch = stretch_near_plane(move, height, dot(triangle.normal, move.displacement));
    if (!(stretch.begin <= stretch.end) || beyond_an_edge(triangle, move.at(stretch.begin), move.at(stretch.end)))
        return never;
    T t = stretch.begin;
    for (int i = 0; i < kSteps; ++i) {
        const Vector<T> place = move.at(t);
        const TrianglePoint<T> nearest = nearest_on_triangle(place, triangle);
        const T distance = std::sqrt(nearest.square);
        const T approach = approach_of(nearest, triangle, place, distance, move.displacement); // times the distance
        if (!(approach > T(0)))
            return never;
        const T excess = distance - Skin<T>::kImpact;
        if (!(excess > Skin<T>::kRest))
            return t;
        t += excess * distance / approach;
        if (!(t <= stretch.end))
            return never;
    }
    return t;
}

/// Half the side of the box in which a proxy minds the mesh, none of whose coordinates is beyond 1.
constexpr int kRegion = 2;

/// Where a straight line from a proxy outside of the region enters it; false if it does not. The line is measured from
/// its end nearer to the region, in double, so that it meets the region where it should.
template <typename T> bool find_entry(const Vector<T>& proxy, const Vector<T>& probe, Vector<T>& place) noexcept {
    constexpr double kSide = kRegion * 0.75;
    const bool back = largest_coordinate(probe) < largest_coordinate(proxy);
    const glm::dvec3 near_end(back ? probe : proxy), far_end(back ? proxy : probe);
    double begin = 0, end = 1;
    for (int i = 0; i < 3; ++i) {
        const double displacement = far_end[i] - near_end[i];
        if (!std::isfinite(displacement))
            return false;
        if (displacement == 0) {
            end = std::abs(near_end[i]) > kSide ? -1 : end;
            continue;
        }
        const double low = (-kSide - near_end[i]) / displacement, high = (kSide - near_end[i]) / displacement;
        begin = std::max(begin, std::min(low, high));
        end = std::min(end, std::max(low, high));
    }
    if (!(begin <= end))
        return false;
    for (int i = 0; i < 3; ++i) {
        const double there = near_end[i] + (back ? end : begin) * (far_end[i] - near_end[i]);
        place[i] = static_cast<T>(std::clamp(there, -kSide, kSide));
    }
    // On the region's border to the last bit, so that it is outside of the mesh.
    int side = std::abs(place[0]) < std::abs(place[1]) ? 1 : 0;
    side = std::abs(place[side]) < std::abs(place[2]) ? 2 : side;
    place[side] = std::copysign(T(kSide), place[side]);
    return true;
}

} // namespace forceshade::reference
