// What is asked about: each stimulus, or each with the standard that it is compared with; and tracks over an axis.
#pragma once

#include "host/experiment/experiment.h"

namespace forceshade::experiment {

/// From the spec and the study. \throws UsageError without a place in the file: the standard names no case or all, or
/// a stimulus is as much like one standard as another.
void find_conditions(Experiment& experiment);

/// After the conditions, if the spec has a track. \throws UsageError likewise: the axis is none, or no track can have
/// its levels.
void find_tracks(Experiment& experiment);

} // namespace forceshade::experiment
