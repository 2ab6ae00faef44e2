// The surface of a scene with the forces on it, as polygons for ParaView (.vtp).
//
// The force of a point is what a probe feels that touches the surface there and is pressed 1 mm deep, against a mesh's
// facet along its normal, elsewhere straight down; by the law in the run's precision, and beside it without shading.
//
// Forces stand on points, and each facet has points of its own at its corners, where the law is that of this facet. So
// an unshaded force is the same all over a facet and jumps at its edges, and a shaded one turns within the facet, as it
// is felt. Numbers on cells would be one for a facet: of the paper's bump of one facet, at whose middle shading changes
// nothing, they would show nothing.
#pragma once

#include <filesystem>

#include "host/field/prepared_case.h"
#include "host/output/rows.h"

namespace forceshade {

/// Polygons in m, in the world's frame; points have `force` (N, the active vector), `unshaded` (N), `turn` (deg,
/// between the two: by how much shading turns the force) and with [compare] `angle` (deg) and `magnitude_error` (N);
/// cells have `facet`, and the whole has `pressed_m`.
/// - A mesh: its facets with all their corners; cell i is facet i. A facet that no probe touches (it has no area, or
///   repeats another) has no force.
/// - A bump: its facets, and the plane beside it as far as the grid reaches along x, as strips as long as the grid
///   along y. A facet that has shading or texture is cut into several strips. Of more than 1024 facets each polygon
///   stands for several and has the number of the first.
/// - A cylinder bump (facet 0; the plane is 1) and a height map (the plane, on which its forces are felt): sampled at
///   the grid's (x, y), or at 512 places along an axis that has more.
/// Along y nothing is cut where the force does not depend on y. \throws IoError, Interrupted, UsageError if a value
/// leaves the range of the run's precision.
VolumeResult write_surface(const std::filesystem::path& path, const PreparedCase& prepared);

/// Bytes of the arrays before they are compressed, at most; of a mesh, which need not have been read, guessed from the
/// size of its file. 0 if there is no such file.
double most_surface_bytes(const Scene& scene);

} // namespace forceshade
