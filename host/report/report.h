// Pages that open anywhere, offline, one file each: report.html of a results folder, and the forces on the probe of a
// run.
#pragma once

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "host/study/study_data.h"

namespace forceshade::report {

struct ReportResult {
    std::filesystem::path file;
    std::size_t findings = 0;
    std::vector<std::string> troubles; /* missing, damaged and foreign files; the report lists them too */
};

/// Writes FOLDER/report.html of its contents: a sweep (manifest.json and volumes) and studies (error-time/study.json
/// and so on) in the folder itself or in folders right below it. An empty folder gives a report that says
/// so. A report.html that another program wrote stays, the report is then forceshade-report.html. \throws IoError if
/// the folder is not there or the file cannot be written.
ReportResult write_report(const std::filesystem::path& folder);

// The page of a run: the forces on a probe, over time and over place.

/// The table "samples" of a file that `explore` or the log of `live` wrote, CSV or EXR, evenly thinned, and its
/// figures: force, direction and position. \throws IoError, UsageError for a file that is missing or none of these.
void add_samples(study::StudyData& data, const std::filesystem::path& file);

/// Facts: terms and their values. Of `data` tables, figures and notes are shown.
std::string run_page(const std::string& title, const std::vector<std::pair<std::string, std::string>>& facts,
                     const study::StudyData& data);

} // namespace forceshade::report
