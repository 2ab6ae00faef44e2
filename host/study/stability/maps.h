// Maps of what loops come to: over stiffness and damping where a surface bears least, and over the step of the measured
// position and friction.
#pragma once

#include <string>
#include <vector>

#include "host/study/stability/limits.h"

namespace forceshade::study {

/// A loop of a map.
struct MapLoop {
    std::string map, surface; /* "damping", "rounding" */
    LoopCell cell;
    LoopOutcome outcome;
    bool foreseen = false; /* that it comes to rest: by the linearised loop; with rounding by
                              K <= min(2 b / T, 2 f_c / quantum), which is enough on a wall */
};

/// Over stiffness and damping at a limit's place; its hold must be one that paths have: down or on all sides.
std::vector<MapLoop> damping_map(Engine& engine, const LoopSurface& surface, const LeastLimit& least, bool quick);

/// Over quantum and friction, the hand pressed down there. The stiffness is the scene's, or 1000 N/m.
std::vector<MapLoop> rounding_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick);

/// A point of a line over a map.
struct MapCurvePoint {
    std::string map, curve;                       /* "K_crit" */
    double stiffness, damping, quantum, friction; /* SI; NaN where it means nothing */
};

/// K_crit and the linearised loop over damping, f_c = K quantum / 2 over quantum: within the maps.
std::vector<MapCurvePoint> curves_over(const std::vector<MapLoop>& loops, const LeastLimit& least);

} // namespace forceshade::study
