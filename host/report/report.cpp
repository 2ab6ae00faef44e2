#include "host/report/report.h"

namespace forceshade::report {

ReportResult write_report(const std::filesystem::path& folder) {
    return {folder / "report.html", 0, {}};
}

} // namespace forceshade::report
