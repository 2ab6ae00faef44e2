#include "host/study/findings/omission_findings.h"

namespace forceshade::study {

std::vector<Finding> omission_findings(const StudyData&) {
    return {};
}

} // namespace forceshade::study
