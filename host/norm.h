// The length of a vector, safe for every finite one.
#pragma once

#include <cmath>

namespace forceshade {

/// sqrt(x^2 + y^2 + z^2) without overflow on the way; NaN if any component is. (std::hypot of three arguments loses a
/// NaN beside zeros.)
inline double norm(double x, double y, double z) {
    return std::hypot(std::hypot(x, y), z);
}

} // namespace forceshade
