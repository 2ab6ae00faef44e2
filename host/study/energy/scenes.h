// The scenes that the study of energy takes of its own.
#pragma once

#include <memory>
#include <string>

#include "host/prepare/prepared_case.h"

namespace forceshade::study {

inline constexpr double kMil = 25.4e-6;      /* m */
inline constexpr double kHalfWidth = 0.0127; /* m: a of the paper, to the bit as scenes have it */
inline constexpr double kLoopEnd = 0.999;    /* of the half width: x1 of the laws' rectangle, inside the bump */
inline constexpr double kStiffness = 500;    /* K, N/m */
inline constexpr double kPaperRadii[] = {600, 1000, 1400}; /* mil */

/// What the force of a bump is made of, in the words of a scene file.
struct BumpForce {
    std::string shading = "none";     /* "reference" */
    std::string depth = "vertical";   /* "normal" */
    std::string reference = "normal"; /* "radial" */
};

/// The paper's bump of n facets; the radius in mil.
PreparedCase bump_scene(double radius_mil, unsigned facets, const BumpForce& force);
/// Plane and cylinder superposed (L2).
PreparedCase cylinder_bump_scene(double radius_mil);
/// The plane shaded by the cylinder as a height map (L5).
PreparedCase height_map_scene(double radius_mil);
/// A mesh that is in memory alone; `name` is what the scene calls its file.
PreparedCase mesh_scene(std::shared_ptr<const SceneMesh> mesh, const std::string& name, const std::string& shading);

/// A section of x and z at y, `columns` by `rows` samples from `low` to `high` (x, z; m).
struct SectionGrid {
    double low[2], high[2];
    double y = 0;
    std::uint64_t columns = 161, rows = 81;
};
/// Sets the grid, double precision, and the channels force and depth.
void set_section(PreparedCase& prepared, const SectionGrid& grid);

} // namespace forceshade::study
