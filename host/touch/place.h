// A place that a hand touches, and how deep hands go.
#pragma once

#include <functional>

#include <glm/vec3.hpp>

namespace forceshade {

struct TouchPlace {
    glm::dvec3 at{0};           /* m */
    glm::dvec3 normal{0, 0, 1}; /* of the surface above it */
    double depth = 0;           /* m: under the surface along the normal; negative above it */
};

/// Lengths that follow from how deep a hand goes, m.
struct TouchScale {
    double deepest = 2e-3;
    double shallowest() const { return deepest / 100; }
    double ring() const { return deepest / 20; }
    double skin() const { return deepest / 40; } /* shallower is boundary */
};

/// N, at a place.
using ForceAt = std::function<glm::dvec3(const TouchPlace&)>;

} // namespace forceshade
