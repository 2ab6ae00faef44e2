// The limit of loops over what sets it: mass, grip, damping, rate and delay, one at a time; and the kicks that die out
// on a device without damping.
#pragma once

#include <span>

#include "host/study/stability/maps.h"

namespace forceshade::study {

/// A place, and what one quantity makes of its limit; all else is the surface's own hand.
struct AtlasPoint {
    LeastLimit least;     /* over the usual holds there; simulated where that takes few steps */
    std::string quantity; /* "mass" */
    double value = 0;     /* SI */

    /// 1: the groups on which a limit depends, besides the delay in samples: K T / b, b T / m, k_g T / b.
    double limit_group() const;
    double mass_group() const;
    double grip_group() const;
};

/// What is varied: mass from a gram to 10 kg, grip from 20 to 5000 N/m, damping from 0.03 to 100 N s/m, rate from 100
/// Hz to 100 kHz, delay from 0 to 8 samples.
struct Quantity {
    const char *name, *unit;
    double low, high; /* SI */
    void (*set)(LoopCell&, double);
};
std::span<const Quantity> quantities();

/// The row with the least limit of those with the hand's own damping, rate and delay; of all surfaces where `surface`
/// is empty, of all depths (m) and kinds without one. Null: none.
const LeastLimit* worst_of(const std::vector<LeastLimit>& limits, const std::string& surface = {},
                           std::optional<double> depth = {}, std::optional<PlaceKind> kind = {});

/// At the worst place of each kind with the surface's own hand: of least_limits of that surface.
std::vector<AtlasPoint> atlas_of(const LoopSurface& surface, const std::vector<LeastLimit>& limits, bool quick);

/// m: kicks up to here die out by friction, N, alone: of a mass, kg, without damping on a wall of `stiffness`, N/m,
/// whose force is held for a sample, s. The hold feeds pi K T w A^2 / 2 a cycle, w = sqrt(K / m), and friction takes 4
/// f_c A, so that A = 8 f_c / (pi K T w). Needs w T far below 1.
double friction_basin(double mass, double friction, double stiffness, double sample_time);

/// Loops on a wall without damping, over stiffness and kick; `foreseen` by friction_basin.
std::vector<MapLoop> basin_map(Engine& engine, const LoopSurface& surface, const RestPlace& place, bool quick);

} // namespace forceshade::study
