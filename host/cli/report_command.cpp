// forceshade report.
#include <filesystem>

#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/program.h"
#include "host/report/report.h"

namespace forceshade {
namespace {

struct ReportArguments {
    std::string folder;
};

int run(const ReportArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const report::ReportResult written = report::write_report(arguments.folder);
    const std::filesystem::path file = std::filesystem::absolute(written.file).lexically_normal();
    if (!common.quiet) {
        for (const std::string& trouble : written.troubles)
            print_note("warning: {}\n", trouble);
        print_note("look at {}\n", file.string());
    }
    if (common.json)
        print_data(nlohmann::ordered_json{
                       {"report", file.string()}, {"findings", written.findings}, {"troubles", written.troubles}}
                       .dump(2) +
                   "\n");
    return written.troubles.empty() ? 0 : static_cast<int>(ExitCode::io);
}

} // namespace

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
