// Where a sampled loop of hand and surface stops being stable: maps over stiffness and what else the limit hangs on.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/run/study_run.h"

namespace forceshade::study {

/// What is to be computed, in parts of some seconds.
std::vector<Step> loop_steps(StudyRun& run);

/// Adds tables, figures and notes, from the steps' results in their order.
void add_loop(StudyData& data, const std::vector<nlohmann::ordered_json>& results);

} // namespace forceshade::study
