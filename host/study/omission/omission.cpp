#include "host/study/omission/omission.h"

namespace forceshade::study {

StudyData study_omission(StudyRun& run) {
    return run.data();
}

} // namespace forceshade::study
