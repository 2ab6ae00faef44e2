// Angles between directions.
#pragma once

#include <cmath>
#include <numbers>

#include "host/reference/elementary.h"

namespace forceshade {

constexpr double kDegree = std::numbers::pi / 180; /* rad */

/// Between two vectors of any length but 0, rad; good however small it is.
inline double angle_between(const reference::Vector<double>& u, const reference::Vector<double>& v) {
    const reference::Vector<double> normal = reference::cross(u, v);
    return std::atan2(reference::length(normal), reference::dot(u, v));
}

} // namespace forceshade
