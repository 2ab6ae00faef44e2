#include "host/scene/case_filter.h"

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"

namespace forceshade {

std::vector<const Case*> cases_named(const Study& study, const std::string& pattern) {
    std::vector<const Case*> chosen;
    for (const Case& one : study.cases)
        if (fnmatch(pattern.c_str(), one.name.c_str(), 0) == 0)
            chosen.push_back(&one);
    if (chosen.empty())
        throw UsageError(fmt::format("--only \"{}\" chooses none of {} cases; the first is {}", pattern,
                                     study.cases.size(), study.cases.empty() ? "" : study.cases.front().name));
    return chosen;
}

} // namespace forceshade
