// Pairs of triangles that touch or cross without having a corner in common.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include <glm/vec3.hpp>

namespace forceshade {

struct SelfIntersections {
    std::size_t pairs = 0;
    bool complete = true; // false: given up after `most_pairs`, or because far too many pairs came near each other
};

/// With exact predicates, over the pairs whose bounding boxes overlap. Corners at the same place are the same corner;
/// triangles without area are passed over. `normals`: of the triangles, 0 for those.
SelfIntersections count_self_intersections(std::span<const glm::dvec3> vertices,
                                           std::span<const std::array<std::uint32_t, 3>> triangles,
                                           std::span<const glm::dvec3> normals, std::size_t most_pairs);

} // namespace forceshade
