// The analysis of one or more folders of data: the paper's Table 2 of it, intervals, tests, the observer fitted.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "host/experiment/experiment.h"
#include "host/experiment/observer.h"
#include "host/experiment/record.h"
#include "host/scene/study.h"
#include "host/study/study_data.h"
#include "host/study/study_run.h"

namespace forceshade::experiment {

/// Data of one experiment.
struct Answers {
    Experiment experiment;
    std::vector<TrialRow> rows; /* those that count */
    std::size_t left_out = 0;   /* rows of practice or without an answer */
    std::vector<std::string>
        excluded{}; /* subjects whose rows are left out, and why: "03 (2 of 8 catch trials right)" */

    std::vector<std::string> subjects() const; /* sorted */
    /// Of a condition (its index) and a subject, or all if it is empty: by answer.
    std::vector<double> counts(std::size_t condition, const std::string& subject = {}) const;
};

/// \throws IoError, UsageError if a folder holds no data, or folders hold different experiments.
Answers read_answers(const std::vector<std::filesystem::path>& folders);

/// The answer that means the smooth shape; nothing if none does.
std::optional<std::size_t> smooth_answer(const ExperimentSpec& spec);

/// For other programs: a row a subject and condition, with counts of answers, or of right ones where two were compared.
study::Table wide_table(const Answers& answers);

/// Conditions, as indices of the study's cases, in the paper's order (Table 2) where they are the paper's, else as they
/// are.
std::vector<std::size_t> shown_order(const Experiment& experiment);

/// The paper's name of a stimulus of Table 2, "two_poly_shaded"; empty: it is none.
std::string paper_name(const Case& stimulus);

/// Tables, figures and findings.
study::StudyData analyse(const Answers& answers);

/// A program in R that reads the table "wide" (wide.csv next to it) and fits generalised linear mixed models to it, by
/// lme4, and, as a comment, by brms.
std::string analysis_script(const Answers& answers);

/// Adds tables, figures, findings and notes.
void add_comparisons(study::StudyData& data, const Answers& answers);

// What the observer expects people to answer: to any list of scenes, how many facets feel round, and how many subjects
// and trials separate two conditions of an experiment.

/// The fewest facets from which on a bump's answers stay within `points` of its cylinder's, in the limit of a rigid
/// surface; nothing if 128 are too few.
std::optional<unsigned> facets_within(double points, double radius, double width, bool shaded,
                                      const ObserverParameters& observer = {});

/// The study "perception": of the user's cases, or the paper's and those of more facets. A case that is stroked without
/// a whole pass (it is no bump) is left out, and a note says so.
study::StudyData study_perception(study::StudyRun& run);

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
