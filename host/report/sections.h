// The page's parts, as markup.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "host/report/contents.h"

namespace forceshade::report {

/// What a study or a sweep found: a sentence each, with the place, the condition and the interval.
std::string findings_list(const std::string& id, const std::vector<study::Finding>& findings);

/// What is missing, damaged or foreign; empty where nothing is.
std::string troubles_section(const std::vector<std::string>& troubles);

/// What the page draws, as JSON: figures, and their tables and others that are not too long.
std::string page_data(const study::StudyData& data);

/// A study: findings beside the first figure, the other figures, methods, tables and files.
std::string study_section(const std::filesystem::path& root, const StudyPart& part);

/// Cases of a sweep: errors, times, what was left out, files.
std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep);

/// For headings and links within the page: "study-energy", "sweep-NAME".
std::string anchor(const StudyPart& part);
std::string anchor(const Sweep& sweep);
std::string title(const StudyPart& part);
std::string title(const Sweep& sweep);
std::string plain_id(const std::string& name);

/// "Run on DEVICE ...": two columns of terms and what they are here.
std::string facts(const std::vector<std::pair<std::string, std::string>>& terms);

} // namespace forceshade::report
