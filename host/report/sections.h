// The page's parts, as markup.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/contents.h"

namespace forceshade::report {

/// What each study and sweep found, the most useful first.
std::string findings_section(const Contents& contents);

/// What is missing, damaged or foreign; empty where nothing is.
std::string troubles_section(const std::vector<std::string>& troubles);

/// Figures, tables and files of a study. A figure that cannot be drawn is added to the troubles. A table of more rows
/// is cut, and says so.
std::string study_section(const std::filesystem::path& root, const StudyPart& part, std::vector<std::string>& troubles,
                          std::size_t most_rows);

/// Cases of a sweep: errors, times, what was left out, files.
std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep);

/// For headings and links within the page: "study-energy", "sweep-NAME".
std::string anchor(const StudyPart& part);
std::string anchor(const Sweep& sweep);
std::string title(const StudyPart& part);
std::string title(const Sweep& sweep);

/// "Run on DEVICE ...": two columns of terms and what they are here.
std::string facts(const std::vector<std::pair<std::string, std::string>>& terms);

} // namespace forceshade::report
