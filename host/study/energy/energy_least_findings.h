// Finding of the study of energy: which schemes give least and most round a loop while they keep to a direction error.
#pragma once

#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study {

constexpr double kRounding = 1e-9; /* of the effort: less energy is none */

/// At the smallest error that nearly all schemes keep to. Without the table, or numbers in it, nothing.
void add_least_at_equal_error(const StudyData& data, std::vector<Finding>& findings);

} // namespace forceshade::study
