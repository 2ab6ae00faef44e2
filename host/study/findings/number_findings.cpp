#include "host/study/findings/number_findings.h"

namespace forceshade::study {

std::vector<Finding> number_findings(const StudyData&) {
    return {};
}

} // namespace forceshade::study
