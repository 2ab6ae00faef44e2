// What error against time says, in at most five sentences.
#pragma once

#include <vector>

#include "host/study/error_time/tables.h"

namespace forceshade::study::error_time {

std::vector<Finding> findings_of(const Measured& measured);

} // namespace forceshade::study::error_time
