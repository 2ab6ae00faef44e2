#include <CLI/CLI.hpp>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/remark.h"
#include "host/report/report.h"

namespace forceshade {
namespace {

int run(const std::string& folder, const CommonOptions& common) {
    const report::ReportResult written = report::write_report(folder);
    const std::filesystem::path file = std::filesystem::absolute(written.file).lexically_normal();
    if (!common.quiet) {
        for (const std::string& trouble : written.troubles)
            remark("warning: {}\n", trouble);
        remark("look at {}\n", file.string());
    }
    if (common.json)
        print_data(nlohmann::ordered_json{
                       {"report", file.string()}, {"findings", written.findings}, {"troubles", written.troubles}}
                       .dump(2) +
                   "\n");
    return written.troubles.empty() ? 0 : static_cast<int>(ExitCode::io);
}

} // namespace

void add_report_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto folder = std::make_shared<std::string>();
    CLI::App* command = program.add_subcommand(
        "report", "Write report.html of a folder of results: sweeps and studies, in one file that opens offline");
    command->add_option("DIR", *folder, "folder that sweep or study wrote")->required();
    command->callback([=, &common, &chosen] { chosen = [=, &common] { return run(*folder, common); }; });
}

} // namespace forceshade
