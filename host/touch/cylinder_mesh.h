// Meshes of the reference cylinder: a closed block under its bump, and an open patch that can be tessellated anew.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"

namespace forceshade {

struct BumpMesh {
    double half_width = 0.0127; /* a, m */
    double radius = 0.0254;     /* R, m: above a */
    unsigned cells = 8;         /* over 2 a along x */
    unsigned rows = 8;          /* over 2 a along y */
};

/// A block of triangles whose top lies on the circle of G1 (z = 0 at |x| = a) between equal arcs, over |y| <= a and, at
/// least a cell beyond |x| = a, to about 1.5 a; diagonals from (i, j) to (i + 1, j + 1). Deeper than wide, so that a
/// probe below the top is nearest to it. Moved by `shift`, m.
std::shared_ptr<const SceneMesh> bump_mesh(const BumpMesh& bump, const glm::dvec3& shift = glm::dvec3(0));

/// A tessellation turned and moved at random, for a disc of `reach`, m along the surface, about the middle.
struct DrawnPatch {
    double reach = 0;
    std::uint64_t seed = 0;
};

/// The cylinder alone as triangles between equal arcs, an open mesh; `bump` gives the cells' size and, unless drawn,
/// their number.
std::shared_ptr<const SceneMesh> cylinder_patch(const BumpMesh& bump, const std::optional<DrawnPatch>& drawn = {});

} // namespace forceshade
