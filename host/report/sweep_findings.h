// What a sweep's manifest says, in a sentence each.
#pragma once

#include <vector>

#include "host/report/contents.h"

namespace forceshade::report {

/// Computed from the cases alone; none for none.
std::vector<study::Finding> sweep_findings(const Sweep& sweep);

} // namespace forceshade::report
