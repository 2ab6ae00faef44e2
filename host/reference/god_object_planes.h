// L6: the projection onto the directions that up to three planes allow: least squares by Lagrange multipliers.
#pragma once

#include <algorithm>
#include <limits>

#include "host/reference/vector.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

/// normal . v >= slack.
template <typename T> struct HalfSpace {
    Vector<T> normal; /* unit */
    T slack;
    layout::uint source; /* whose it is */
};

/// The vector nearest to a wish among those that the half-spaces allow, and the half-spaces that hold it there.
template <typename T> struct Projection {
    Vector<T> vector;
    HalfSpace<T> held[3];
    T multipliers[3]; /* vector - wish = sum multipliers * normals, none below 0 but for rounding */
    layout::uint count = 0;
};

template <typename T> T largest_of(const Vector<T>& v) noexcept {
    const T x = std::abs(v.x), y = std::abs(v.y), z = std::abs(v.z);
    const T xy = x > y ? x : y;
    return xy > z ? xy : z;
}

template <typename T> Projection<T> onto_plane(const Vector<T>& wish, const HalfSpace<T>& one) noexcept {
    Projection<T> result;
    const T multiplier = one.slack - dot(one.normal, wish);
    result.vector = wish + multiplier * one.normal;
    // Once more for what rounding leaves of a long wish.
    result.vector += (one.slack - dot(one.normal, result.vector)) * one.normal;
    result.held[0] = one;
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
    result.held[0] = one;
    result.held[1] = other;
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
        result.held[i] = *spaces[i];
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
        const T rounding = least + T(8) * std::numeric_limits<T>::epsilon() * largest_of(vector);
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

/// Adds a half-space that `now` violates. False, and nothing changed, if no vector satisfies them all.
template <typename T>
bool hold_also(const Vector<T>& wish, const HalfSpace<T>& added, const Tolerance<T>& tolerance,
               Projection<T>& now) noexcept {
    const HalfSpace<T>* held = now.held;
    Projection<T> next = onto_plane(wish, added);
    bool found = is_nearest(next, held, now.count, tolerance);
    for (layout::uint i = 0; !found && i < now.count; ++i) {
        next = onto_line(wish, added, held[i]);
        found = is_nearest(next, held, now.count, tolerance);
    }
    for (layout::uint i = 0; !found && i < now.count; ++i)
        for (layout::uint j = i + 1; !found && j < now.count; ++j) {
            next = onto_corner(wish, added, held[i], held[j]);
            found = is_nearest(next, held, now.count, tolerance);
        }
    if (found)
        now = next;
    return found;
}

/// Projects a wish onto half-spaces that `worst(vector, half_space)` tells one at a time: it returns whether the vector
/// violates one by more than the tolerance, and which. Each one added takes the vector further from the wish, so this
/// ends. False if no vector was found.
template <typename T, typename Worst>
bool project(const Vector<T>& wish, const Tolerance<T>& tolerance, Projection<T>& result, Worst&& worst) noexcept {
    constexpr int kRounds = 64;
    result.count = 0;
    result.vector = wish;
    HalfSpace<T> violated;
    for (int i = 0; i < kRounds; ++i) {
        if (!worst(result.vector, violated))
            return true;
        if (!hold_also(wish, violated, tolerance, result))
            return false;
    }
    return false;
}

} // namespace forceshade::reference
