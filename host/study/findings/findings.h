// The findings of any study.
#pragma once

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// In the order of weight, the most useful first. \throws DataError for a study that this program does not know, or
/// where a table or column is missing that a finding needs.
std::vector<Finding> findings_of(const StudyData& data);

} // namespace forceshade::study
