// From polygons as a file has them to the mesh that the laws work on: placed, cut into triangles, with normals.
#pragma once

#include <array>

#include "host/mesh/mesh.h"
#include "host/mesh/normals.h"

namespace forceshade {

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
