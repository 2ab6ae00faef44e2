// The files of `forceshade live`.
#pragma once

#include <filesystem>
#include <string>

#include "host/scene/scene.h"

namespace forceshade {

struct LiveFiles {
    std::string scene, device, log; // as on the command line; log: empty if none
    std::filesystem::path report;   // STEM of the report; empty: none
};

/// Where the report goes: to `report`, as on the command line, or beside the log `name`, unless that is no regular
/// file; empty: nowhere.
std::filesystem::path live_report_stem(const std::string& report, const std::string& name);

/// Before anything is felt: what is written at the end has a place, and nothing that is read is written over.
/// \throws UsageError, IoError.
void check_live_outputs(const LiveFiles& files, const Scene& scene);

} // namespace forceshade
