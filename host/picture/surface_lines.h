// The outlines that a picture of a field shows over the forces.
#pragma once

#include "host/picture/picture.h"
#include "host/prepare/prepared_case.h"

namespace forceshade {

/// Where a section in the x-z plane lies.
struct SectionSpan {
    double from = 0, to = 0; /* m: x */
    double y = 0;            /* m */
};

/// The surface that depth is measured from, and the shape that shading imitates (empty without shading).
picture::SurfaceLines surface_lines(const PreparedCase& prepared, const SectionSpan& section);

/// The same over the grid.
picture::SurfaceLines surface_lines(const PreparedCase& prepared, double y /* m */);

} // namespace forceshade
