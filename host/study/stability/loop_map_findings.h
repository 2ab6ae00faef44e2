// Sentences on the maps of sampled loops.
#pragma once

#include <string>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Rounding against friction; empty where the maps tell nothing of it. \throws DataError where a column is missing.
std::string friction_finding(const Table& maps);

} // namespace forceshade::study
