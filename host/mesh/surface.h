// The triangles of a mesh that the laws work on: no redundant ones, none without area, and no vertex within
// an edge that facets without area have joined to it.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/mesh/mesh.h"
#include "host/mesh/prepare_mesh.h"

namespace forceshade {

/// Triangles as in Mesh, facets ascending.
struct Surface {
    std::vector<std::array<std::uint32_t, 3>> corners;
    std::vector<std::uint32_t> facets;
    std::vector<glm::dvec3> normals;
};

/// The mesh's triangles without redundant facets and without needles of two equal corners (their two
/// sides are one edge), closed over its caps. A cap has a corner on its longest side: exactly, or to within the
/// rounding of the world's coordinates, where its normal is noise. It says that this corner lies on that side, and
/// goes; every other triangle with that side is cut in two there, through caps of caps too, so that edges match whose
/// triangles met across caps. The pieces keep plane, normal and facet. A cap with an area stays if nobody else has its
/// longest side. \returns null if these are the mesh's triangles as they are
std::unique_ptr<const Surface> make_surface(const Mesh& mesh, const MeshFrame& frame);

} // namespace forceshade
