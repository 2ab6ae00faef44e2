#include "host/study/stability/stability_findings.h"

#include "host/study/stability/loop_findings.h"
#include "host/study/stability/number_findings.h"

namespace forceshade::study {

std::vector<Finding> stability_findings(const StudyData& data) {
    std::vector<Finding> findings = loop_findings(data);
    for (Finding& finding : number_findings(data))
        findings.push_back(std::move(finding));
    return findings;
}

} // namespace forceshade::study
