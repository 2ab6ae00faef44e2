// Case names: what varies over a study, in file order, safe as file names everywhere.
#pragma once

#include "host/scene/selection.h"
#include "host/scene/study.h"

#include <string>
#include <vector>

namespace forceshade {

/// Fills in `name` and `varied` of each case. `selections` are the cases' own, `order` the order of keys
/// (Document::order). Names that would be equal, or equal but for upper and lower case, or too long, end in a hash of
/// the case's values.
void name_cases(std::vector<Case>& cases, const std::vector<Selection>& selections,
                const std::vector<std::size_t>& order);

} // namespace forceshade
