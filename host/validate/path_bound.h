// How far rounding may take a sample of a path on hardware from the oracle's: derived a priori.
#pragma once

#include "host/validate/reading.h"
#include "host/validate/rounding_bound.h"

namespace forceshade {

/// Of an analytic surface. What is felt is held against the law at the very place where it was felt (RoundingBound,
/// both sides round, edges excused as in excuse.h); what the device can display of it adds 16 u of its largest force.
///
/// Where an open loop's probe is follows from numbers without rounding (phases, random words, steps) in one chain. With
/// u the unit roundoff and S the sum of all lengths that a motion is made of (middle, half sides, depths, lift, every
/// harmonic's amplitude), a coordinate is off by at most (128 + 2 harmonics) u S: the longest chain is that of a
/// minimum-jerk stretch, 40 u for the share of the way (its division 2.5 ULP, its derivative below 2, the polynomial's
/// terms up to 15), twice that for points two half sides apart, and the turn into the world; a sum of harmonics rounds
/// twice for each. One that follows the surface is off by what the surface's height changes over that, and by the
/// height's own error. Recorded places are copied and must be the very same.
template <typename T> class PathBound {
public:
    /// The case must outlive the bound.
    explicit PathBound(const PreparedCase& prepared);

    /// m: the sum of lengths S of one path's motion, the only one of the batch.
    static double size(const layout::PathBatch<T>& one);

    /// m: how far apart two roundings of an open loop's place may be.
    double place(const layout::PathFeatures& features, double size, const Triple& at) const;

    /// Whether that is what the law gives at the probe, or may be taken for it. `hand`: of a closed loop, else null.
    bool allows(const layout::Law<T>& law, const layout::HandParams<T>* hand, const Reading& felt, const Triple& probe,
                layout::uint channels) const;

private:
    RoundingBound bound_;
};

extern template class PathBound<float>;
extern template class PathBound<double>;

} // namespace forceshade
