// An engine's field of a mesh held against the oracles on every voxel, and against plain loops on some.
#pragma once

#include "host/validate/validate.h"

namespace forceshade {

/// Adds what compare_case counts, for a case whose surface is a mesh, evaluated in T. The closed form's place takes the
/// brute referee, which loops over all triangles: on evenly chosen voxels, so many that the loops stay within some
/// seconds.
template <typename T> void compare_mesh(Engine& engine, const PreparedCase& prepared, Comparison& result);

extern template void compare_mesh<float>(Engine&, const PreparedCase&, Comparison&);
extern template void compare_mesh<double>(Engine&, const PreparedCase&, Comparison&);

} // namespace forceshade
