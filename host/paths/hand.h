// The hand and the device of a scene, as an engine takes them.
#pragma once

#include "host/scene/scene.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// In closed loop. The grip's spring pulls to the path along x and y, and along z unless the hand presses with a given
/// force; its damping acts on the speed against the path's, the device's on the speed. `bound`, m: PathRegion.
/// \throws UsageError if a value leaves the range of T.
template <typename T> layout::HandParams<T> hand_params(const HandSpec& hand, const PathsSpec& paths, double bound);

// Mass, damping and spring over one sample, exactly (laws: sampled stability).

/// One axis: mass x'' + damping x' + stiffness (x - target) = force.
struct Axis {
    double mass = 0;      /* kg, positive */
    double damping = 0;   /* N s/m, not negative */
    double stiffness = 0; /* N/m, not negative */
};

/// Its exact map over `period` seconds during which target and force are held (zero-order hold): under-, over- and
/// critically damped, and without damping or spring. No coefficient loses digits where it is small beside others.
layout::AxisMap<double> axis_map(const Axis& axis, double period);

} // namespace forceshade
