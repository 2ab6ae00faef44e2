// report.html of a results folder: one file that opens anywhere, offline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace forceshade::report {

struct ReportResult {
    std::filesystem::path file;
    std::size_t findings = 0;
    std::vector<std::string> troubles; /* what is missing, damaged or not of this program; the report says it too */
};

/// Writes FOLDER/report.html of what is there: a sweep (manifest.json and volumes) and studies (error-time/study.json
/// and so on) in the folder itself or in folders right below it. A folder with nothing in it gives a report that says
/// so. A report.html that another program wrote stays, the report is then forceshade-report.html. \throws IoError if
/// the folder is not there or the file cannot be written.
ReportResult write_report(const std::filesystem::path& folder);

} // namespace forceshade::report
