// Normals of triangles, facets and vertices of a mesh.
#pragma once

#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "host/mesh/mesh.h"

namespace forceshade {

/// How the normals of a vertex's facets are weighted in the vertex's own (L7).
enum class VertexNormals {
    plain, // alike, as in the paper
    angle  // by the facet's angle at the vertex, which does not depend on how a face was cut into facets
};

/// The unit normal of a triangle, counterclockwise seen from where it points; good to a few units in the last place
/// whatever the triangle's shape, place and size. 0 if and only if the corners are collinear.
glm::dvec3 triangle_normal(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c);

/// The unit Newell normal of each facet: that of the area vector, which is the plane's where the facet is plane. 0
/// where the area vector is 0 to within the rounding of twice double's precision.
std::vector<glm::dvec3> facet_normals(const PolygonSoup& polygons);

/// The unit normal of each vertex (see VertexNormals). 0 where the facets' normals cancel to within 1e-12 of the sum of
/// their weights, and where no facet with an area is. A facet that comes to a vertex twice counts once in `plain`, with
/// the sum of its angles in `angle`; a reflex corner has an angle beyond pi. Facets in `left_out` (ascending) count for
/// nothing.
std::vector<glm::dvec3> vertex_normals(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals,
                                       VertexNormals weights, std::span<const std::uint32_t> left_out = {});

} // namespace forceshade
