// Mass, damping and spring over one sample, exactly (laws: sampled stability).
#pragma once

#include "shaders/shared/layout.h"

namespace forceshade {

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
