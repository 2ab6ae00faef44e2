#include "host/study/stability/stability_findings.h"

#include "host/study/stability/loop_findings.h"

namespace forceshade::study {

std::vector<Finding> stability_findings(const StudyData& data) {
    return loop_findings(data);
}

} // namespace forceshade::study
