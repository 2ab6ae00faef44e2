// The end of a run for a program. The keys are those of device/README.md.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "device/loop/outcome.h"

namespace forceshade::device {

/// Never throws on what a device says of itself: bad UTF-8 becomes U+FFFD.
nlohmann::ordered_json report_json(const LiveOutcome& outcome);

} // namespace forceshade::device
