// The outlines that a picture of a field shows over the forces.
#pragma once

#include "host/field/prepared_case.h"
#include "host/picture/picture.h"

namespace forceshade {

/// In the x-z plane at the middle y of the grid: the surface that depth is measured from, and the shape that shading
/// imitates (empty without shading).
picture::SurfaceLines surface_lines(const PreparedCase& prepared);

} // namespace forceshade
