// The end of a run as files.
#pragma once

#include <filesystem>

#include "device/loop/outcome.h"

namespace forceshade::device {

/// STEM.txt, STEM.json and STEM.png, each whole or not at all. Throws IoError.
void write_live_report(const LiveOutcome& outcome, const std::filesystem::path& stem);

} // namespace forceshade::device
