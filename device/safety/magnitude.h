// How large a force is, as the oracle's hand says it (reference::commanded).
#pragma once

#include <cmath>

#include <glm/vec3.hpp>

#include "host/reference/vector.h"

namespace forceshade::device {

inline double magnitude(const glm::dvec3& v) noexcept {
    return std::sqrt(reference::dot(v, v));
}

} // namespace forceshade::device
