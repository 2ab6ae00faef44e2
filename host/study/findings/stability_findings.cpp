#include "host/study/findings/stability_findings.h"

namespace forceshade::study {

std::vector<Finding> stability_findings(const StudyData&) {
    return {};
}

} // namespace forceshade::study
