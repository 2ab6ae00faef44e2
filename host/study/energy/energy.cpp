#include "host/study/energy/energy.h"

namespace forceshade::study {

StudyData study_energy(StudyRun& run) {
    return run.data();
}

} // namespace forceshade::study
