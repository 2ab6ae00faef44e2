// A model of who answers in the classification experiment: a Poisson race of "an edge on the crest" against "a level
// top", after a bump was felt at all. Its structure was chosen with the paper's Table 2 in sight.
#pragma once

#include <array>
#include <vector>

namespace forceshade::experiment {

inline constexpr double kMil = 25.4e-6; /* m */

/// The four pictures of the 1996 experiment, in the order of their keys.
enum class Picture { flat, two_facets, three_facets, cylinder };
inline constexpr std::size_t kPictures = 4;
inline constexpr std::array<const char*, kPictures> kPictureNames{"flat", "two_poly", "three_poly", "cylinder"};
/// Of 1, by Picture; their sum is 1.
using Shares = std::array<double, kPictures>;

/// What a stroke across a feature gives to feel, over its middle: samples in the order of x.
struct StrokeSignals {
    double width = 0;          /* m: of the feature; samples reach from -width/2 to width/2 */
    std::vector<double> x;     /* m: from the feature's middle, increasing */
    std::vector<double> force; /* 1: F_x / F_z */
    std::vector<double> path;  /* 1: -dz/dx of the path traced, signed as the force */
};

/// What a stroking hand keeps: the vertical force, or the depth. At constant depth the force has one magnitude, which
/// takes the place of F_z: lateral ratios are sines of the force's angle where else they are tangents.
enum class Hold { force, depth };

/// In the limit of a rigid surface and a small force, where the path is the nominal surface: a bump of that radius and
/// width, m, of so many facets of equal angles (0: the cylinder). Shaded: the force has the cylinder's direction.
StrokeSignals rigid_signals(double radius, double width, unsigned facets, bool shaded, Hold hold = Hold::force);

/// How the observer counts what keeps a top from being level.
enum class LevelRule {
    threshold, /* what is below `level` times the steepest is level */
    base_kinks /* only what is exactly level is; kinks at the base are taken for a facet's edges */
};

struct Cues {
    double force_jump = 0, path_jump = 0;   /* 1: across 0.1 mm at the crest */
    double force_level = 0, path_level = 0; /* 1: share of the width */
    double steepest = 0;                    /* 1: the largest |F_x / F_z| */
    double base = 0;                        /* 1: |F_x / F_z| at the base */
};

/// `level`: of the steepest lateral force, as in ObserverParameters. \throws UsageError for fewer than 3 samples.
Cues cues_of(const StrokeSignals& signals, double level);

/// Fitted to Table 2 (fit.h).
struct ObserverParameters {
    double edge = 0.7588;        /* 1: kappa, jump of the lateral force ratio for an expected edge */
    double level_gain = 7.162;   /* 1: g, events of a wholly level bump */
    double path_weight = 0.0603; /* 1: w, of the path beside the force */
    double noise = 0.0754;       /* 1: nu, of the force's direction (4.3 deg) */
    double level = 0.0745;       /* 1: rho, of the steepest: what is less counts as level. Of base_kinks: b */
    double lapse = 0.02;         /* 1: lambda, answers by chance; not fitted */
    LevelRule rule = LevelRule::threshold;
};

/// Of the steepest lateral force: what the observer's rule counts as level.
double level_of(const ObserverParameters& observer);

/// What is expected to be noticed: whether a bump is felt at all, and then the numbers of the race (Poisson).
struct Events {
    double felt = 0;              /* 1: probability */
    double edges = 0, levels = 0; /* 1: expected numbers of "an edge" and "a level top" */
};
Events events_of(const Cues& cues, const ObserverParameters& observer);

Shares shares_of(const Cues& cues, const ObserverParameters& observer);
Shares shares_of(const StrokeSignals& signals, const ObserverParameters& observer);

} // namespace forceshade::experiment
