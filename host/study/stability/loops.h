// Sampled loops run by an engine, a path each, and their final states.
#pragma once

#include <vector>

#include "host/field/engine.h"
#include "host/limits/limits.h"

namespace forceshade::study {

/// The final state of a loop. stable: its largest speed in the last quarter of the time is less than 3/4 of that in the
/// second, or negligible against the disturbance, or falls and is too slow to move a tenth of the disturbance in that
/// quarter, or the measured position does not change any more. unstable: it left its bound. limit_cycle: neither.
/// quantisation_cycle: a limit cycle in which the measured position changes by one quantum at most.
enum class LoopState { stable, quantisation_cycle, limit_cycle, unstable };

const char* word_of(LoopState state);

struct LoopRun {
    double disturbance = 0.1; /* of the depth: how far too deep the probe begins */
    double bound = 3;         /* depths: a probe further from its place than this has left; a late force is missing
                                 in the first sample, and the resulting swing is added twice */
    double patience = 400;    /* 1: how long a path is, in times that damping takes */
    std::size_t steps = 0;    /* of each path; 0: settling_steps of the slowest */
    bool all_sides = false;   /* the grip's spring holds the hand along z, too */
    bool swings = false;      /* measure LoopOutcome::swing */
};

/// The outcome of a loop.
struct LoopOutcome {
    LoopState state = LoopState::stable;
    double early = 0, late = 0; /* m/s: largest speeds in the second quarter of the time and in the last */
    bool left = false;          /* its bound */
    bool at_rest = false;       /* its speed is negligible against the disturbance's */
    double moved = 0; /* m: from its place to the middle of the farthest positions of the last quarter; as swing */
    double swing = 0; /* m: between its farthest measured positions, along the axis of the most, in the last
                         quarter; with LoopRun::swings or where the hand measures in quanta */
};

/// All cells at once, in double where the engine has it.
std::vector<LoopOutcome> run_cells(Engine& engine, const LoopSurface& surface, const RestPlace& place,
                                   const std::vector<LoopCell>& cells, const LoopRun& run);

} // namespace forceshade::study
