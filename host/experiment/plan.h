// How many subjects and trials tell two conditions apart, as the observer expects their answers.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "host/experiment/experiment.h"

namespace forceshade::experiment {

/// How far subjects differ: the correlation of two answers of a subject to one condition. From Table 2, whose rows of 5
/// subjects and 24 trials spread 2.75 times as much about the observer as answers by chance: (2.75 - 1) / (24 - 1).
inline constexpr double kSubjectCorrelation = 1.75 / 23;

/// The subjects that a number of trials of each condition wants.
struct PlannedSubjects {
    unsigned trials = 0;              /* of each condition */
    std::optional<unsigned> subjects; /* nothing: more than kMostSubjects */
};
inline constexpr unsigned kMostSubjects = 60;

struct Plan {
    std::string first, second;                /* conditions */
    std::string answer;                       /* whose share is compared: the one that differs most */
    double first_share = 0, second_share = 0; /* of 1: expected */
    std::vector<PlannedSubjects> needed;
};

/// Power: the share of simulated experiments in which the test that analyse makes of the difference of the subjects'
/// shares (sign_flip_p) is significant (5 %). Answers of a subject are beta-binomial.
double power_of(double first, double second, unsigned trials, unsigned subjects);

/// For 80 % power. \throws UsageError for an experiment without the paper's answers, or a name that is no condition's.
Plan planned(const Experiment& experiment, const std::string& first, const std::string& second);

/// Pairs worth comparing where none are named: each shaded stimulus and the same unshaded.
std::vector<std::pair<std::string, std::string>> natural_pairs(const Experiment& experiment);

} // namespace forceshade::experiment
