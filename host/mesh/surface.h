// The triangles that stand for a mesh's facets, and those of them that the laws work on.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

/// One representative for all vertices at the same place: the lowest. `vertices` has three numbers a vertex.
std::vector<std::uint32_t> weld(std::span<const double> vertices);

std::vector<std::uint32_t> weld(const PolygonSoup& polygons);

/// What is the same for two pairs of places if and only if they are the ends of the same edge.
inline std::uint64_t edge_of(std::uint32_t place, std::uint32_t other) noexcept {
    return place < other ? std::uint64_t(place) << 32 | other : std::uint64_t(other) << 32 | place;
}

struct Triangles {
    std::vector<std::array<std::uint32_t, 3>> corners; /* vertices, wound as their facet */
    std::vector<std::uint32_t> facets;                 /* of each triangle, ascending */
};

/// K - 2 triangles for each facet of K corners, the same ones in every run:
/// - a triangle as it is, from its first corner;
/// - a convex quadrilateral cut along its shorter diagonal, along the one from its first corner if they are equal; one
///   with a reflex or straight corner, from that corner;
/// - more corners: the constrained Delaunay triangulation of the facet's projection along its Newell normal;
/// - a fan from the first corner where that is impossible: the projection crosses or touches itself, or the facet has
///   no area.
/// \param facet_normals unit Newell normals, 0 where a facet has no area
Triangles triangulate(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals);

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
