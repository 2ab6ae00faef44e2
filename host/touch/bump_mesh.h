// Closed meshes of the reference cylinder's bump.
#pragma once

#include <memory>

#include "host/field/prepared_case.h"

namespace forceshade {

struct BumpMesh {
    double half_width = 0.0127; /* a, m */
    double radius = 0.0254;     /* R, m: at least 1.5 a */
    unsigned cells = 8;         /* over 2 a along x */
    unsigned rows = 8;          /* over 2 a along y */
};

/// A block of triangles whose top, over |x| <= 1.5 a and |y| <= a, lies on the circle of G1 (z = 0 at |x| = a);
/// diagonals from (i, j) to (i + 1, j + 1). Deeper than wide, so that a probe below the top is nearest to it.
/// Moved by `shift`, m.
std::shared_ptr<const SceneMesh> bump_mesh(const BumpMesh& bump, const glm::dvec3& shift = glm::dvec3(0));

} // namespace forceshade
