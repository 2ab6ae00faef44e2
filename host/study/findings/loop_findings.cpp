#include "host/study/findings/loop_findings.h"

namespace forceshade::study {

std::vector<Finding> loop_findings(const StudyData&) {
    return {};
}

} // namespace forceshade::study
