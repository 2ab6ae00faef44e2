// The frame that a mesh's structure is in.
#pragma once

#include <glm/vec3.hpp>

#include "host/mesh/mesh.h"

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

} // namespace forceshade
