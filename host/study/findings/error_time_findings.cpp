#include "host/study/findings/error_time_findings.h"

namespace forceshade::study {

std::vector<Finding> error_time_findings(const StudyData&) {
    return {};
}

} // namespace forceshade::study
