// Findings that hold two ways of coming by the same force against each other: look-up and direct, god-object and static
// field, kernel and CPU, single and double precision.
#pragma once

#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Adds what the table of points tells. \throws DataError where a column is missing.
void add_ways(std::vector<Finding>& findings, const StudyData& data);

} // namespace forceshade::study
