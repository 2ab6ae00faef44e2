// The stiffness up to which loops are stable: the minimum over places and boundary conditions, by kind of place, depth,
// damping, rate and delay; and maps of the loops' states over stiffness and damping at the lowest limit of a surface,
// and over the step of the measured position and friction.
#pragma once

#include <optional>

#include "host/study/stability/linear_loop.h"
#include "host/study/stability/loops.h"

namespace forceshade::study {

/// The least limit of all places of a kind at a depth.
struct LeastLimit {
    std::string surface;
    RestPlace place;                 /* the worst */
    Hold hold;                       /* the worst */
    LoopCell cell;                   /* hand and rate */
    bool own = false;                /* with the hand's own damping and delay, at its own rate */
    double wall = 0;                 /* N/m: K_crit with this hand */
    std::optional<double> limit;     /* N/m: of the linearised loop; empty: none below eight times the passive one */
    std::optional<double> simulated; /* N/m: of the loop stepped through the surface's own force, where that was done */
    std::optional<double> kick;      /* m: largest_kick, where that was done */
    std::size_t places = 0;          /* examined */
};

/// A row for each kind but jumps, depth, damping, rate and delay: the hand's own and around it.
std::vector<LeastLimit> least_limits(const LoopSurface& surface, const std::vector<RestPlace>& places, bool quick);

/// The stiffness, N/m, at which a disturbance of a millionth of the depth begins to grow when the loop is stepped
/// through the surface's own force, from 0.3 of the linearised limit on; empty: none up to three times that.
std::optional<double> simulated_limit(const LoopSurface& surface, const LeastLimit& least);

/// m: of 0.1, 0.2, 0.5, 1 ... 100 um the largest displacement that decays at half the linearised limit, as all smaller
/// ones do; 0 if none does.
std::optional<double> largest_kick(const LoopSurface& surface, const LeastLimit& least);

/// The oscillation of a probe that rests on a jump of the direction.
struct EdgeSwing {
    std::string surface;
    RestPlace place;
    double stiffness = 0; /* N/m */
    LoopOutcome outcome;
};

/// Of the eight sharpest jumps of each kind and depth, the one with the largest swing, over stiffnesses; with the
/// surface's own hand pressed down.
std::vector<EdgeSwing> edge_swings(Engine& engine, const LoopSurface& surface, const std::vector<RestPlace>& places);

/// A loop of a map.
struct MapLoop {
    std::string map, surface; /* "damping", "rounding" */
    LoopCell cell;
    LoopOutcome outcome;
    bool foreseen = false; /* to come to rest: by the linearised loop; with rounding by
                              K <= min(2 b / T, 2 f_c / quantum), which is enough on a wall */
};

/// Over stiffness and damping at a limit's place; its hold must be one that paths have: down or on all sides.
std::vector<MapLoop> damping_map(Engine& engine, const LoopSurface& surface, const LeastLimit& least, bool quick);

/// Over quantum and friction, the hand pressed down there. The stiffness is the scene's, or 1000 N/m.
std::vector<MapLoop> rounding_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick);

/// A point of a line over a map.
struct MapCurvePoint {
    std::string map, curve;                       /* "K_crit" */
    double stiffness, damping, quantum, friction; /* SI; NaN: does not apply */
};

/// K_crit and the linearised loop over damping, f_c = K quantum / 2 over quantum: within the maps.
std::vector<MapCurvePoint> curves_over(const std::vector<MapLoop>& loops, const LeastLimit& least);

} // namespace forceshade::study
