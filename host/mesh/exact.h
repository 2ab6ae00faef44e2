// Geometry with CGAL's exact arithmetic and predicates: for the few triangles that defeat twice the precision of
// double, for polygons in the plane, and for triangles that meet.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

namespace forceshade {

/// (b - a) x (c - a) computed exactly, times a positive factor that makes its largest component about 1, rounded once;
/// 0 if and only if a, b, c are collinear. Microseconds a call.
glm::dvec3 exact_cross_direction(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// The constrained Delaunay triangulation: appends to `triangles` the K - 2 triangles (corner numbers,
/// counterclockwise, by least corner) of a simple polygon of K corners that runs counterclockwise. The same input gives
/// the same triangles, cocircular corners included. Returns false, and appends none, if the polygon crosses or
/// touches itself.
bool planar_delaunay(std::span<const std::array<double, 2>> polygon,
                     std::vector<std::array<std::uint32_t, 3>>& triangles);

/// Which way a, b, c turn in the plane: 1 counterclockwise, -1 clockwise, 0 if they are collinear.
int turn_of(const std::array<double, 2>& a, const std::array<double, 2>& b, const std::array<double, 2>& c);

/// Whether two triangles that have an area touch or cross.
bool triangles_meet(const std::array<glm::dvec3, 3>& one, const std::array<glm::dvec3, 3>& other);

} // namespace forceshade
