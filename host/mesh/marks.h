// The places that a picture of a mesh marks.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "host/mesh/findings.h"
#include "host/mesh/structure.h"

namespace forceshade {

struct MeshMarks {
    using Edge = std::array<glm::dvec3, 2>; /* m */

    std::vector<Edge> rims;              // of one facet
    std::vector<Edge> crowded;           // of more than two
    std::vector<Edge> sharp;             // of two whose normals differ by more than kSharp
    std::vector<bool> inward;            // of each facet: it disagrees with its piece, or its piece is inside out
    std::vector<std::uint32_t> crossing; // triangles of Mesh, ascending, that touch or cross others

    static constexpr double kSharp = 60; /* deg */
};

/// \param structure of the mesh
MeshMarks find_marks(const Mesh& mesh, const MeshStructure& structure, const MeshFindings& findings);

} // namespace forceshade
