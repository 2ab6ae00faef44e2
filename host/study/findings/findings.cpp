#include "host/study/findings/findings.h"

#include <fmt/format.h>

#include "host/study/data/data_error.h"
#include "host/study/findings/energy_findings.h"
#include "host/study/findings/error_time_findings.h"
#include "host/study/findings/omission_findings.h"
#include "host/study/findings/stability_findings.h"

namespace forceshade::study {

std::vector<Finding> findings_of(const StudyData& data) {
    if (data.study == "error-time")
        return error_time_findings(data);
    if (data.study == "stability")
        return stability_findings(data);
    if (data.study == "energy")
        return energy_findings(data);
    if (data.study == "omission")
        return omission_findings(data);
    throw DataError(fmt::format("no study is called \"{}\"", data.study));
}

} // namespace forceshade::study
