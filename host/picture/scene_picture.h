// What a scene says of its pictures: their title, and the outlines over the forces.
#pragma once

#include <string>

#include "host/field/prepared_case.h"
#include "host/picture/picture.h"

namespace forceshade {

namespace picture {

/// "Bump of 2 facets, radius 15.2 mm, shaded as its cylinder, stiffness 2 N/mm": the surface, its shading, and whatever
/// else varies in the case's study.
std::string title_of(const Case& one, bool with_shading = true);

/// "100 paths (strokes)".
std::string paths_title(const PathsSpec& paths);

} // namespace picture

/// Where a section in the x-z plane lies.
struct SectionSpan {
    double from = 0, to = 0; /* m: x */
    double y = 0;            /* m */
};

/// The surface that depth is measured from, and the shape that shading imitates (empty without shading).
picture::SurfaceLines surface_lines(const PreparedCase& prepared, const SectionSpan& section);
/// The same over the grid.
picture::SurfaceLines surface_lines(const PreparedCase& prepared, double y /* m */);

/// m: 1 mm; on a bump narrower than 20 mm a twentieth of its width.
double pressed_depth(const Scene& scene);

/// A stroke over the grid at one y, m, with the probe at one depth straight below the surface, where it has one; N, in
/// double precision and without a history.
struct SceneStroke {
    std::vector<picture::StrokedForce> forces;
    double depth = 0; /* m */
};
SceneStroke stroke_of(const PreparedCase& prepared, double y);

} // namespace forceshade
