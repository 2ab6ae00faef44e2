// Where numbers of single precision leave those of double: how far forces differ over sizes, stiffnesses and distances,
// and what explains it.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/run/study_run.h"

namespace forceshade::study {

/// What is to be computed, in parts of some seconds.
std::vector<Step> number_steps(StudyRun& run);

/// Adds tables, figures and notes, from the steps' results in their order.
void add_number(StudyData& data, const std::vector<nlohmann::ordered_json>& results);

} // namespace forceshade::study
