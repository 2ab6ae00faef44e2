// The length of a vector, safe for every finite one.
#pragma once

#include <cmath>

namespace forceshade {

/// sqrt(x^2 + y^2 + z^2) without overflow on the way; NaN if any component is. (std::hypot of three arguments loses a
/// NaN next to zeros.)
inline double norm(double x, double y, double z) {
    return std::hypot(std::hypot(x, y), z);
}
/// Of a vector with members x, y and z.
template <typename Vector> double norm(const Vector& v) {
    return norm(double(v.x), double(v.y), double(v.z));
}

} // namespace forceshade
