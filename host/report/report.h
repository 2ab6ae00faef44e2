// report.html of a results folder: one file that opens anywhere, offline.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

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

} // namespace forceshade::report
