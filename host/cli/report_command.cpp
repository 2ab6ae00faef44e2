// forceshade report, and the report that other commands end with.
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/report/report.h"
#include "host/study/study_data.h"

namespace forceshade {

namespace {

struct ReportArguments {
    std::string folder;
};

int run(const ReportArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const report::ReportResult written = report::write_report(arguments.folder);
    const std::string file = full_path(written.file);
    print_warnings(written.troubles, common);
    note(common, "look at {}\n", file);
    if (common.json)
        print_data(
            nlohmann::ordered_json{{"report", file}, {"findings", written.findings}, {"troubles", written.troubles}}
                .dump(2) +
            "\n");
    return written.troubles.empty() ? 0 : static_cast<int>(ExitCode::io);
}

} // namespace

int show_findings(const study::StudyData& data, const std::filesystem::path& folder, const std::string& made,
                  const char* what, const CommonOptions& common) {
    const report::ReportResult written = report::write_report(folder);
    for (const study::Finding& finding : data.findings)
        note(common, "- {}\n", finding.text);
    note(common, "{}look at {}, {} in {}\n", made, full_path(written.file), what, full_path(folder / data.study));
    if (common.json)
        print_data(study::data_json(data));
    return 0;
}

void add_report_command(CommandLine& program) {
    program.add<ReportArguments>(
        "report", "Write report.html of a folder of results: sweeps and studies, in one file that opens offline", run,
        [](Options& options, ReportArguments& arguments) {
            options.required("DIR", arguments.folder, "folder that sweep or study wrote")
                .example("report bumps", "after a sweep's files were changed or copied")
                .example("report results --json", "where it is, for a script");
        });
}

} // namespace forceshade
