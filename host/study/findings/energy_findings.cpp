#include "host/study/findings/energy_findings.h"

namespace forceshade::study {

std::vector<Finding> energy_findings(const StudyData&) {
    return {};
}

} // namespace forceshade::study
