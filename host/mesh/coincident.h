// Facets with the same corners, by place, and which of them count.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

/// Facets coincide if they come to the same places in the same or the opposite cyclic order.
/// - The same order: a repeat of the first one in the file.
/// - The opposite order, both with an area: of such a pair one is a stray if without it the edges match better. That
///   is, along more than half of the pair's edges the facets of the mesh walk more often its way than the other, and
///   along none less often. Strays that share edges with strays are found out one from the other.
/// - Else a pair is a sheet of two sides, or a wall within a solid: no way to match edges tells either side from the
///   other.
struct CoincidentFacets {
    std::vector<std::uint32_t> redundant; /* ascending: repeats and strays; they count for nothing */
    std::size_t opposed = 0;              /* pairs of which both count */
};

/// \param facet_normals 0 where a facet has no area
CoincidentFacets find_coincident(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals);

/// The same vertices, and the facets that are not in `left_out` (ascending).
PolygonSoup without_facets(const PolygonSoup& polygons, std::span<const std::uint32_t> left_out);

} // namespace forceshade
