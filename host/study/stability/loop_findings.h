// Findings on where a sampled loop stops being stable, each a sentence computed from its tables.
#pragma once

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// \throws DataError where a table or column is missing that a finding needs.
std::vector<Finding> loop_findings(const StudyData& data);

} // namespace forceshade::study
