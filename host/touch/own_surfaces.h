// The surfaces of the studies' own, and closed meshes of the reference cylinder's bump.
#pragma once

#include <cstdint>
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

inline constexpr double kOwnHalfWidth = 0.0127;  /* a, m: half the width of the paper's bumps */
inline constexpr double kOwnWavelength = 0x1p-6; /* m: of the sine; a power of two, so that whole ones add up exactly */

/// A bump of the paper's width about the origin, or another form of it.
struct OwnSurface {
    SurfaceKind kind = SurfaceKind::bump;
    MapFunction function = MapFunction::cylinder; /* of a height map */
    bool shaded = false;                          /* of a mesh by mean value coordinates */
    double radius = 2 * kOwnHalfWidth;            /* R, m */
    std::uint32_t facets = 8;                     /* of a bump; of a mesh the cells along x */
    std::uint32_t rows = 8;                       /* of a mesh: cells along y */
    double stiffness = 1000;                      /* N/m */
};

/// `shift`, m: of a mesh.
PreparedCase own_case(const OwnSurface& own, const glm::dvec3& shift = glm::dvec3(0));

} // namespace forceshade
