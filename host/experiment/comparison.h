// The analysis of the task compare: shares of right answers, and thresholds of adaptive tracks.
#pragma once

#include "host/experiment/analysis.h"

namespace forceshade::experiment {

/// Adds tables, figures, findings and notes.
void add_comparisons(study::StudyData& data, const Answers& answers);

} // namespace forceshade::experiment
