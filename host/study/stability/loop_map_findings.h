// Sentences on the maps of sampled loops.
#pragma once

#include <string>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Empty where the maps tell nothing of it.
struct LoopMapFindings {
    std::string friction; /* rounding against friction */
    std::string sides;    /* how many loops are on the side of the closed form that it says */
};

/// \throws DataError where a column is missing.
LoopMapFindings loop_map_findings(const Table& maps);

} // namespace forceshade::study
