// The study of work round closed loops and curl.
#pragma once

#include "host/study/run/study_run.h"

namespace forceshade::study {

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_energy(StudyRun& run);

} // namespace forceshade::study
