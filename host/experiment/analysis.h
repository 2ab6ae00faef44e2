// The analysis of one or more folders of data: the paper's Table 2 of it, intervals, tests, the observer fitted.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/experiment/experiment.h"
#include "host/experiment/fit.h"
#include "host/experiment/record.h"
#include "host/study/data/study_data.h"

namespace forceshade::experiment {

/// Data of one experiment.
struct Answers {
    Experiment experiment;
    std::vector<TrialRow> rows; /* those that count */
    std::size_t left_out = 0;   /* rows of practice or without an answer */

    std::vector<std::string> subjects() const; /* sorted */
    /// Of a condition (its index) and a subject, or all if it is empty: by answer.
    std::vector<double> counts(std::size_t condition, const std::string& subject = {}) const;
};

/// \throws IoError, UsageError if a folder holds no data, or folders hold different experiments.
Answers read_answers(const std::vector<std::filesystem::path>& folders);

/// Conditions, as indices of the study's cases, in the paper's order (Table 2) where they are the paper's, else as they
/// are.
std::vector<std::size_t> shown_order(const Experiment& experiment);

/// The paper's name of a stimulus of Table 2, "two_poly_shaded"; empty: it is none.
std::string paper_name(const Case& stimulus);

/// Tables, figures and findings.
study::StudyData analyse(const Answers& answers);

/// Adds tables, figures, findings and notes.
void add_comparisons(study::StudyData& data, const Answers& answers);

} // namespace forceshade::experiment
