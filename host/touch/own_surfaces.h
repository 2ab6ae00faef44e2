// The surfaces of the studies' own.
#pragma once

#include <cstdint>

#include "host/field/prepared_case.h"
#include "host/touch/bump_mesh.h"

namespace forceshade {

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
