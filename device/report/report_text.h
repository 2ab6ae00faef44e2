// The end of a run in words, for the person at the terminal.
#pragma once

#include <string>

#include "device/loop/outcome.h"

namespace forceshade::device {

/// Some 25 lines of at most 100 columns.
std::string report_text(const LiveOutcome& outcome);

/// "60000 samples in 60 s at 1 kHz", or as fast as possible; one sentence, for the picture too.
std::string pace_text(const LiveOutcome& outcome, std::string_view micro = "u");
/// "3 samples late (0.005 %), 0 of them by our own computing"; that none can be, as fast as possible.
std::string lateness_text(const LiveOutcome& outcome);
/// "clamped 12, ramping 200" without the late ones; "none".
std::string events_text(const LoopCounts& counts);
/// What was largest: "force 3.2 N by the law, 3 N commanded; ..."
std::string extremes_text(const LoopCounts& counts, std::string_view micro = "u");
/// "1.2 mJ given to the hand at the end, ..."
std::string energy_text(const LoopCounts& counts, std::string_view micro = "u");

} // namespace forceshade::device
