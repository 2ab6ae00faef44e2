// The stiffness up to which loops rest: the least over places and holds, by kind of place, depth, damping, rate and
// delay.
#pragma once

#include <optional>

#include "host/study/stability/linear_loop.h"
#include "host/study/stability/loops.h"

namespace forceshade::study {

/// The least limit of all places of a kind at a depth.
struct LeastLimit {
    std::string surface;
    RestPlace place;                 /* the worst */
    Hold hold;                       /* likewise */
    LoopCell cell;                   /* hand and rate */
    bool own = false;                /* with the hand's own damping and delay, at its own rate */
    double wall = 0;                 /* N/m: K_crit with this hand */
    std::optional<double> limit;     /* N/m: of the linearised loop; nothing: none below eight times the passive one */
    std::optional<double> simulated; /* N/m: of the loop stepped through the surface's own force, where that was done */
    std::optional<double> kick;      /* m: largest_kick, likewise */
    std::size_t places = 0;          /* that were looked at */
};

/// A row for each kind but jumps, depth, damping, rate and delay: the hand's own and around it.
std::vector<LeastLimit> least_limits(const LoopSurface& surface, const std::vector<RestPlace>& places, bool quick);

/// The stiffness, N/m, at which a disturbance of a millionth of the depth begins to grow when the loop is stepped
/// through the surface's own force, from 0.3 of the linearised limit on; nothing if none does up to three times that.
std::optional<double> simulated_limit(const LoopSurface& surface, const LeastLimit& least);

/// m: of 0.1, 0.2, 0.5, 1 ... 100 um the largest displacement that dies out at half the linearised limit, as all
/// smaller ones do; 0 if none does.
std::optional<double> largest_kick(const LoopSurface& surface, const LeastLimit& least);

/// How a probe that rests on a jump of the direction swings.
struct EdgeSwing {
    std::string surface;
    RestPlace place;
    double stiffness = 0; /* N/m */
    LoopOutcome outcome;
};

/// At the eight sharpest jumps of each kind and depth, that which swings most, over stiffnesses; with the surface's own
/// hand pressed down.
std::vector<EdgeSwing> edge_swings(Engine& engine, const LoopSurface& surface, const std::vector<RestPlace>& places);

} // namespace forceshade::study
