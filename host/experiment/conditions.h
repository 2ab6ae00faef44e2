// What is asked about: each stimulus, or each with the standard that it is compared with; and tracks over an axis.
#pragma once

#include "host/experiment/experiment.h"

namespace forceshade::experiment {

/// Fills in conditions and tracks from the spec and the study. \throws UsageError without a place in the file: a
/// pattern that names no case or all, an axis that is none or whose levels no track can have.
void arrange(Experiment& experiment);

} // namespace forceshade::experiment
