// Cases of a study by a pattern of their names, as `--only` gives it.
#pragma once

#include <string>
#include <vector>

#include "host/scene/study.h"

namespace forceshade {

/// The cases whose name a shell pattern matches, in the study's order; they live as long as the study.
/// \throws UsageError if there is none.
std::vector<const Case*> cases_named(const Study& study, const std::string& pattern);

} // namespace forceshade
