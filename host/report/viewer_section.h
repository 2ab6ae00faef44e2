// The interactive viewer of a report's force volumes: their data, packed into the page, and the place it draws in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/contents.h"

namespace forceshade::report {

/// Of all characters that the volumes take in the page.
inline constexpr std::size_t kViewerBudget = 7'000'000;

/// Empty where no sweep has a force volume that can be read; a volume that cannot is added to the troubles. Volumes are
/// thinned until all fit into `budget`, and the page says so.
std::string viewer_section(const std::filesystem::path& root, const std::vector<Sweep>& sweeps,
                           std::vector<std::string>& troubles, std::size_t budget = kViewerBudget);

} // namespace forceshade::report
