#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/remark.h"
#include "host/scene/case_filter.h"
#include "host/sweep/progress.h"
#include "host/validate/validate.h"

namespace forceshade {
namespace {

struct ValidateArguments {
    std::string study, only = "*";
};

// Single and double precision where the user asks for neither and the device has both.
std::vector<Precision> precisions(const CommonOptions& common, const EngineReport& engine) {
    if (common.precision == "f32")
        return {Precision::f32};
    if (common.precision == "f64")
        return {Precision::f64};
    if (engine.f64)
        return {Precision::f32, Precision::f64};
    if (!common.quiet)
        remark("{} has no double precision: only f32 is validated\n", engine.device);
    return {Precision::f32};
}

int run(const ValidateArguments& arguments, const CommonOptions& common) {
    const Study study = load_study(arguments.study, common);
    const std::vector<const Case*> cases = cases_named(study, arguments.only);
    const auto engine = make_engine(engine_options(common, common.precision == "f64"));
    const std::vector<Precision> wanted = precisions(common, engine->report());
    CasePreparation preparation;
    std::vector<Comparison> comparisons;
    std::set<std::string> warned;
    Progress progress("comparisons", cases.size() * wanted.size(), common.quiet);
    for (const Case* one : cases) {
        const PreparedCase prepared = preparation.prepare(*one);
        for (const std::string& warning : prepared.warnings)
            if (warned.insert(warning).second)
                print_warnings({warning}, common);
        for (const Precision precision : wanted) {
            comparisons.push_back(compare_case(*engine, prepared, precision));
            progress.update(comparisons.size(), one->name);
        }
    }
    const Totals totals = totals_of(comparisons);
    if (common.json)
        print_data(comparison_json(comparisons, engine->report()) + "\n");
    else
        print_data(comparison_table(comparisons) +
                   fmt::format("{} voxels, {} differ\n", totals.voxels, totals.differing));
    if (!totals.passed && !common.quiet)
        remark("a bound was exceeded on {}\n", engine->report().device);
    return totals.passed ? 0 : 1;
}

} // namespace

void add_validate_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto arguments = std::make_shared<ValidateArguments>();
    CLI::App* command = program.add_subcommand(
        "validate", "Hold the device against the CPU oracle and the closed forms, on every voxel");
    command->add_option("SCENE-or-STUDY", arguments->study,
                        "TOML file; without it the paper's study, which is built in");
    command->add_option("--only", arguments->only, "shell pattern of case names");
    command->callback([=, &common, &chosen] { chosen = [=, &common] { return run(*arguments, common); }; });
}

} // namespace forceshade
