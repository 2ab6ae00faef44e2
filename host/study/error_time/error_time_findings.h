// Findings of the study of error against run time, each a sentence computed from its tables.
#pragma once

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// \throws DataError where a table or column is missing that a finding needs.
std::vector<Finding> error_time_findings(const StudyData& data);

} // namespace forceshade::study
