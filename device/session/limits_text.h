// Safety's limits as a person reads them.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "device/safety/limits.h"

namespace forceshade::device {

/// By name, with units; "none" for a limit that is switched off.
std::vector<std::pair<std::string, std::string>> limits_as_text(const SafetyLimits& limits);

} // namespace forceshade::device
