// The frame that a mesh's structure is in.
#pragma once

#include <array>

#include <glm/vec3.hpp>

#include "host/mesh/mesh.h"
#include "host/mesh/normals.h"

namespace forceshade {

/// (world - centre) / scale: centre the middle of the bounding box, scale the least power of two that leaves no
/// coordinate beyond 1.
struct MeshFrame {
    glm::dvec3 centre; /* m, world */
    double scale;      /* m */

    glm::dvec3 local(const glm::dvec3& world) const { return (world - centre) / scale; }
};

/// Of the corners of facets only: a vertex that none uses has no say.
/// \throws UsageError if the box is no finite number of metres
MeshFrame frame_of(const PolygonSoup& polygons);

// From polygons as a file has them to the mesh that the laws work on: placed, cut into triangles, with normals.

/// Where a mesh stands in the world: scaled by unit * scale about the file's origin, then rotated about the fixed axes
/// x, y and z in this order, then moved.
struct MeshPlacement {
    double unit = 1;                   /* m: what a coordinate of 1 means */
    double scale = 1;                  /* 1 */
    std::array<double, 3> rotate{};    /* rad; quarter turns are exact */
    std::array<double, 3> translate{}; /* m */
};

/// Facets and vertices keep their order and numbers. How facets are cut into triangles: triangulate.h; what the normals
/// are: normals.h. Corners must be in range.
/// \throws UsageError if unit * scale is not positive, or a coordinate is beyond 1e100 m or not finite
Mesh prepare_mesh(PolygonSoup polygons, const MeshPlacement& placement, VertexNormals vertex_normals);

} // namespace forceshade
