#include "host/study/stability/stability.h"

namespace forceshade::study {

StudyData study_stability(StudyRun& run) {
    return run.data();
}

} // namespace forceshade::study
