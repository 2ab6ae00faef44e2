#include "host/study/error_time/error_time.h"

namespace forceshade::study {

StudyData study_error_time(StudyRun& run) {
    return run.data();
}

} // namespace forceshade::study
