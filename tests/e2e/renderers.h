// Renderers of other people: the two examples, and some that do wrong.
#pragma once

#include "tests/places.h"

namespace forceshade::testing {

inline const std::string kPenalty = module_of("e2e", "penalty"), kOneConstraint = module_of("e2e", "one_constraint"),
                         kBadRenderer = module_of("e2e", "bad_renderer"), kBadVersion = module_of("e2e", "bad_version"),
                         kBadSymbols = module_of("e2e", "bad_symbols");

} // namespace forceshade::testing
