// Normals of corners where not all facets at a vertex share one: smoothing groups, and creases.
#pragma once

#include <span>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

/// The unit normal of each corner: the plain average over those facets at its vertex that are smooth with its own. By
/// `groups` those of the same smoothing group (PolygonSoup::groups; a facet of group 0 is smooth with none). By
/// `crease` those that are connected with it across edges there at which the facets' normals differ by no more than
/// the angle. 0 where they cancel, and at corners of facets that have no area or are left out.
/// \param smoothing weights must be `groups` or `crease`
std::vector<glm::dvec3> corner_normals(const Connectivity& mesh, std::span<const glm::dvec3> facet_normals,
                                       const Smoothing& smoothing, std::span<const std::uint32_t> left_out);

} // namespace forceshade
