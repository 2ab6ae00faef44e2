// The intended motion of a path from its number: speeds, depths and directions drawn, phases counted.
#pragma once

#include "host/paths/draws.h"
#include "host/paths/region.h"
#include "shaders/shared/layout.h"

namespace forceshade {

/// Turns as a phase, 2^-32 turns, whole turns left out; 0 for what is no number.
std::uint32_t phase_of_turns(double turns);

/// How fast a path goes.
struct PathPace {
    double speed = 0; /* m/s */
    double turns = 0; /* a sample: of a round there and back, whole ones included; 0 for what has no round or way */
};

PathPace path_pace(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

/// The motion of a path, in double. All begin at phase 0: strokes and lines at their end, circles and spirals along the
/// heading, spirals at their smallest radius, taps at the top. A way of no length is not gone along.
layout::MotionParams<double> path_motion(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

/// Whether paths that do not tremble differ from each other.
bool paths_differ(const PathsSpec& paths);

/// Rounded once to T.
template <typename T> layout::MotionParams<T> rounded_motion(const layout::MotionParams<double>& motion);

/// The mean distance of two points anywhere in a rectangle with these sides, m.
double mean_distance(double side, double other);

} // namespace forceshade
