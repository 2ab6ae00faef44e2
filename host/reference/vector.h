// Vectors of the oracle. Products are written out from left to right, as the kernels have them: GLM's dot and
// normalize round otherwise.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include <glm/vec3.hpp>

namespace forceshade::reference {

template <typename T> using Vector = glm::vec<3, T>;

template <typename T> T dot(const Vector<T>& u, const Vector<T>& v) noexcept {
    return u.x * v.x + u.y * v.y + u.z * v.z;
}

template <typename T> Vector<T> cross(const Vector<T>& u, const Vector<T>& v) noexcept {
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// v / |v|; 0 where v.v is not above 0.
template <typename T> Vector<T> normalised(const Vector<T>& v) noexcept {
    const T square = dot(v, v);
    if (!(square > T(0)))
        return Vector<T>(T(0));
    const T length = std::sqrt(square);
    return {v.x / length, v.y / length, v.z / length};
}

/// The vector that stands at `index` in a table of three numbers each.
template <typename T> Vector<T> vector_at(std::span<const T> table, std::size_t index) noexcept {
    return {table[3 * index], table[3 * index + 1], table[3 * index + 2]};
}

} // namespace forceshade::reference
