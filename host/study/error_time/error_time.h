// The study of error against run time.
#pragma once

#include "host/study/run/study_run.h"

namespace forceshade::study {

/// Tables and figures; findings are computed of them elsewhere. \throws what StudyRun::run throws, UsageError for a
/// scene that the study cannot use.
StudyData study_error_time(StudyRun& run);

} // namespace forceshade::study
