// The cross product of two edges in exact arithmetic, for the few triangles that defeat twice the precision of double.
#pragma once

#include <glm/vec3.hpp>

namespace forceshade {

/// (b - a) x (c - a) computed exactly, times a positive factor that makes its largest component about 1, rounded once;
/// 0 if and only if a, b, c are collinear. Microseconds a call.
glm::dvec3 exact_cross_direction(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

} // namespace forceshade
