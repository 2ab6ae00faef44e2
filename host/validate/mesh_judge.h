// An engine's field of a mesh held against the oracles on every voxel, and against plain loops on some.
#pragma once

#include "host/validate/validate.h"

namespace forceshade {

/// As compare_case, for a case whose surface is a mesh. The closed form's place takes the brute referee, which loops
/// over all triangles: on evenly chosen voxels, so many that the loops stay within some seconds.
Comparison compare_mesh(Engine& engine, const PreparedCase& prepared, Precision precision);

} // namespace forceshade
