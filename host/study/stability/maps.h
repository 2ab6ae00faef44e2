// The limits of loops for hands like the surface's own, by damping, rate and delay; and maps of the loops' states over
// stiffness and damping at the lowest limit of a surface, and over the step of the measured position and friction.
#pragma once

#include <cmath>
#include <span>

#include "host/study/stability/loops.h"

namespace forceshade::study {

/// The surface's own hand, linear, then others around it.
std::vector<LoopCell> settings_of(const LoopSurface& surface, bool quick);

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
    std::string map, surface; /* "damping", "coupling", "rounding", "basin" */
    LoopCell cell;
    LoopOutcome outcome;
    bool foreseen = false; /* to come to rest: by the linearised loop; with rounding by
                              K <= min(2 b / T, 2 f_c / quantum), which is enough on a wall */
    double kick = 0;       /* m: where kicks are varied */
};

/// Loops of a map at once, all with as many steps.
void run_row(Engine& engine, const LoopSurface& surface, const RestPlace& place, std::span<MapLoop> loops,
             const LoopRun& run);

/// Value number i of `count` in even ratios from `low` to `high`, with four digits: what is chosen freely is chosen
/// short.
double short_between(double low, double high, int i, int count);

/// The loop with this damping, N s/m, of device and hand together.
LoopCell damped(LoopCell cell, double damping);

/// Over stiffness and damping at a limit's place; its hold must be one that paths have: down or on all sides.
std::vector<MapLoop> damping_map(Engine& engine, const LoopSurface& surface, const LeastLimit& least, bool quick);

/// Over stiffness and damping of a virtual coupling (the Z-width of Colgate & Brown 1994), pressed down onto a scene of
/// 1e6 N/m there.
std::vector<MapLoop> coupling_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick);

/// Over quantum and friction, the hand pressed down there. The stiffness is the scene's, or 1000 N/m.
std::vector<MapLoop> rounding_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick);

/// A point of a line over a map.
struct MapCurvePoint {
    std::string map, curve;                             /* "K_crit" */
    double stiffness, damping, quantum, friction, kick; /* SI; NaN: does not apply */
    double coupling = NAN, coupling_damping = NAN;      /* N/m, N s/m: of a virtual coupling */
};

/// K_crit and the linearised loop over damping, the linearised loop and what is passive over couplings, f_c = K quantum
/// / 2 over quantum, friction_basin over stiffness: within the maps.
std::vector<MapCurvePoint> curves_over(const std::vector<MapLoop>& loops, const LeastLimit& least);

} // namespace forceshade::study
