// A model of who answers in the classification experiment: a Poisson race of "an edge on the crest" against "a level
// top", after a bump was felt at all. Its structure was chosen with the paper's Table 2 in sight.
#pragma once

#include <array>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace forceshade::experiment {

inline constexpr double kMil = 25.4e-6; /* m */

/// The four pictures of the 1996 experiment, in the order of their keys.
inline constexpr std::size_t kPictures = 4;
inline constexpr std::array<const char*, kPictures> kPictureNames{"flat", "two_poly", "three_poly", "cylinder"};
/// Of 1, by picture; their sum is 1.
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

/// What the observer's noise and its threshold for "level" are. The last two were there before; they have five fitted
/// parameters, the first three, the second four.
enum class ObserverModel {
    weber,        /* one Weber fraction of force, 0.07 (Pang, Tan & Durlach 1991), for both */
    weber_fitted, /* the same, with the fraction fitted */
    two_noises,   /* a number for each */
    base_kinks    /* only what is exactly level is; kinks at the base are taken for a facet's edges */
};
inline constexpr std::array<const char*, 4> kObserverModelNames{"weber", "weber-fitted", "two-noises", "base-kinks"};

struct Cues {
    double force_jump = 0, path_jump = 0;   /* 1: across 0.1 mm at the crest */
    double force_level = 0, path_level = 0; /* 1: share of the width */
    double steepest = 0;                    /* 1: the largest |F_x / F_z| */
    double base = 0;                        /* 1: |F_x / F_z| at the base */
};

/// `level`: of the steepest lateral force, as level_of() gives it. \throws UsageError for fewer than 3 samples.
Cues cues_of(const StrokeSignals& signals, double level);

/// Fitted to Table 2; the default ones are those of `weber`, frozen in predictions.toml before any new data.
struct ObserverParameters {
    ObserverModel model = ObserverModel::weber;
    double edge = 0.7347;        /* 1: kappa, jump of the lateral force ratio for an expected edge */
    double level_gain = 7.228;   /* 1: g, events of a wholly level bump */
    double path_weight = 0.0604; /* 1: w, of the path against the force */
    double weber = 0.07; /* 1: W, just noticeable share of a force; nu, noise of its direction, of the last two */
    double level = 0;    /* 1: of two_noises rho, threshold for level; of base_kinks b, gain of such a kink */
    double lapse = 0.02; /* 1: lambda, answers by chance; not fitted */
};

/// How far the simulated subjects differ: the standard deviation of the logarithm of each fitted number. With it their
/// shares of Table 2's answers differ as much as the paper's subjects' (kSubjectCorrelation).
inline constexpr double kSubjectSpread = 0.5;

/// One of many subjects: the fitted numbers of `mean`, each times a factor that is drawn from the subject's name.
ObserverParameters observer_of(const ObserverParameters& mean, std::string_view subject);

/// As published for each model.
ObserverParameters published_observer(ObserverModel model);

/// Of the steepest lateral force: what the observer counts as level.
double level_of(const ObserverParameters& observer);

/// What is expected to be noticed: whether a bump is felt at all, and then the numbers of the race (Poisson).
struct Events {
    double felt = 0;              /* 1: probability */
    double edges = 0, levels = 0; /* 1: expected numbers of "an edge" and "a level top" */
};
Events events_of(const Cues& cues, const ObserverParameters& observer);

/// Percentage points: half the sum of the differences of two distributions of answers.
double apart(const Shares& one, const Shares& other);

Shares shares_of(const Cues& cues, const ObserverParameters& observer);
Shares shares_of(const StrokeSignals& signals, const ObserverParameters& observer);

// The observer held against answers: deviance, maximum likelihood, and prediction of conditions that were left out.

/// The answers to one stimulus.
struct ConditionAnswers {
    std::string name;      /* "two_poly_shaded" */
    std::string group;     /* "600 mil" */
    StrokeSignals signals; /* what the stroke displays */
    Shares answered;       /* of 1 */
    double trials = 0;     /* 1 */
};

/// The paper's Table 2: 7 bumps, 3 radii, 5 subjects and 24 trials each; rows as printed, each normalised to 1. Groups
/// are radii; signals those of the rigid limit.
std::vector<ConditionAnswers> table_2();

/// 2 sum O ln(O / E): twice the log likelihood ratio of the saturated model and `expected`.
double deviance(const ConditionAnswers& row, const Shares& expected);
double deviance(std::span<const ConditionAnswers> rows, const ObserverParameters& observer);

/// Percentage points: the mean of |answered - expected| over rows and pictures.
double mean_error(std::span<const ConditionAnswers> rows, const std::vector<Shares>& expected);

/// The parameters of least deviance, `start`'s model and lapse kept: Nelder-Mead (NLopt) from several places, in
/// logarithms.
ObserverParameters fitted(std::span<const ConditionAnswers> rows, const ObserverParameters& start = {});

/// 95 % of the parameters that answers drawn anew from the fitted shares give (parametric bootstrap), as many of them
/// as the trials count for: a deviance above the degrees of freedom divides the trials (over-dispersion).
struct ObserverRange {
    ObserverParameters low, high;
    double dispersion = 1; /* 1: deviance over degrees of freedom, at least 1 */
};
ObserverRange bootstrapped(std::span<const ConditionAnswers> rows, const ObserverParameters& best);

/// A parameter of an observer that is fitted.
struct FreeParameter {
    const char *name, *meaning;
    double ObserverParameters::*member;
};
/// Those of a model, as published.
std::span<const FreeParameter> free_parameters(ObserverModel model);

/// What each row is expected to be by the others alone, groups of them left out in turn.
struct Prediction {
    std::vector<Shares> expected;                         /* by row */
    std::vector<std::pair<std::string, double>> by_group; /* deviance, in the order of the rows */
    double deviance = 0;
    double error = 0; /* percentage points: mean_error() */
};

/// What rows that are left out together have in common: a radius (`group`) or a stimulus (`name`).
using LeftOut = std::string ConditionAnswers::*;

/// The observer fitted to the other groups.
Prediction predicted_by_observer(std::span<const ConditionAnswers> rows, const ObserverParameters& start = {},
                                 LeftOut left_out = &ConditionAnswers::group);

/// The mean answers to a condition of the same name in the other groups, half an answer added to each picture
/// (Jeffreys).
Prediction predicted_by_means(std::span<const ConditionAnswers> rows);

} // namespace forceshade::experiment
