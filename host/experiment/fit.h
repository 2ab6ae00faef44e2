// The observer held against answers: deviance, maximum likelihood, and prediction of conditions that were left out.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "host/experiment/observer.h"

namespace forceshade::experiment {

/// The answers to one stimulus.
struct ConditionAnswers {
    std::string name;      /* "two_poly_shaded" */
    std::string group;     /* "600 mil" */
    StrokeSignals signals; /* what is felt */
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
