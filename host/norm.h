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

/// Whether a force, N, is a finite number whose square is one, too; others have no meaning.
template <typename Vector> bool is_force(const Vector& v) {
    constexpr double kMost = 1e100;
    return std::abs(double(v.x)) < kMost && std::abs(double(v.y)) < kMost && std::abs(double(v.z)) < kMost;
}

} // namespace forceshade
