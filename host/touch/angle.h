// Angles between directions, and directions across one.
#pragma once

#include <cmath>
#include <numbers>
#include <utility>

#include "host/reference/elementary.h"

namespace forceshade {

constexpr double kDegree = std::numbers::pi / 180; /* rad */

/// Between two vectors of any length but 0, rad; good however small it is.
inline double angle_between(const reference::Vector<double>& u, const reference::Vector<double>& v) {
    const reference::Vector<double> normal = reference::cross(u, v);
    return std::atan2(reference::length(normal), reference::dot(u, v));
}

/// Two unit vectors across a unit vector, and across each other.
inline std::pair<reference::Vector<double>, reference::Vector<double>>
directions_across(const reference::Vector<double>& direction) {
    using Vector = reference::Vector<double>;
    const Vector u = reference::cross(direction, std::abs(direction.x) < 0.5 ? Vector(1, 0, 0) : Vector(0, 1, 0));
    const Vector unit = u / reference::length(u);
    return {unit, reference::cross(direction, unit)};
}

} // namespace forceshade
