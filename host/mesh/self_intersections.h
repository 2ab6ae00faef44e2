// Where a mesh meets itself.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

/// Pairs of triangles that touch or cross without having a corner in common.
struct SelfIntersections {
    std::size_t pairs = 0;
    std::vector<std::uint32_t> triangles; // of these pairs, ascending
    bool complete = true; // false: given up after `most_pairs`, or because far too many pairs came near each other
};

/// With exact predicates, over the pairs whose bounding boxes overlap. Corners at the same place (`places`: of each
/// vertex, from weld()) are the same corner; triangles without area are passed over. The result does not depend on
/// the threads (0: most_threads()).
SelfIntersections count_self_intersections(const PolygonSoup& polygons, std::span<const std::uint32_t> places,
                                           const MeshTriangles& triangles, std::size_t most_pairs,
                                           unsigned threads = 0);

} // namespace forceshade
