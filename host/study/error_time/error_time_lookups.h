// Findings about reading forces from precomputed volumes: against evaluating them directly, and tricubic against
// trilinear.
#pragma once

#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Adds what a table of points tells. \throws DataError where a column is missing.
void add_lookups(std::vector<Finding>& findings, const Table& points);

} // namespace forceshade::study
