// The constrained Delaunay triangulation of a polygon in the plane, with exact predicates.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

namespace forceshade {

/// Appends to `triangles` the K - 2 triangles (corner numbers, counterclockwise, by least corner) of a simple polygon
/// of K corners that runs counterclockwise. The same input gives the same triangles, cocircular corners included.
/// Returns false, with nothing appended, if the polygon crosses or touches itself.
bool planar_delaunay(std::span<const std::array<double, 2>> polygon,
                     std::vector<std::array<std::uint32_t, 3>>& triangles);

} // namespace forceshade
