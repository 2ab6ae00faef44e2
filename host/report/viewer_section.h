// The interactive viewer of a report's force volumes: their data, packed into the page, and the place it draws in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/contents.h"

namespace forceshade::report {

/// Empty where neither a sweep nor a study has a force volume that can be read; a volume that cannot is added to the
/// troubles. Volumes are thinned until all fit into `budget` characters, and the page says so.
std::string viewer_section(const std::filesystem::path& root, const Contents& contents,
                           std::vector<std::string>& troubles, std::size_t budget);

} // namespace forceshade::report
