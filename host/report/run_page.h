// The page of a run: the forces on a probe, over time and over place.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::report {

/// The table "samples" of a file that `explore` or the log of `live` wrote, CSV or EXR, evenly thinned, and its
/// figures: force, direction and position. \throws IoError, UsageError for a file that is missing or none of these.
void add_samples(study::StudyData& data, const std::filesystem::path& file);

/// Facts: terms and their values. Of `data` tables, figures and notes are shown.
std::string run_page(const std::string& title, const std::vector<std::pair<std::string, std::string>>& facts,
                     const study::StudyData& data);

} // namespace forceshade::report
