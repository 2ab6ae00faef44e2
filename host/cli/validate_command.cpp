#include <set>

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cli/command.h"
#include "host/path_run/path_comparison.h"
#include "host/paths/recorded_paths.h"
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

// What was compared, and whether all of it passed.
struct Compared {
    std::vector<Comparison> fields;
    std::vector<PathComparison> paths;

    bool passed() const { return totals_of(fields).passed && totals_of(paths).passed; }
};

void print(const Compared& compared, const CommonOptions& common, const EngineReport& engine) {
    const Totals voxels = totals_of(compared.fields);
    const PathTotals samples = totals_of(compared.paths);
    if (common.json) {
        nlohmann::ordered_json json = nlohmann::ordered_json::parse(comparison_json(compared.fields, engine));
        if (!compared.paths.empty()) {
            json["paths"] = nlohmann::ordered_json::parse(path_comparison_json(compared.paths));
            json["samples"] = samples.samples;
            json["samples_differing"] = samples.differing;
            json["passed"] = compared.passed();
        }
        print_data(json.dump(2) + "\n");
        return;
    }
    std::string text;
    if (!compared.fields.empty())
        text +=
            comparison_table(compared.fields) + fmt::format("{} voxels, {} differ\n", voxels.voxels, voxels.differing);
    if (!compared.paths.empty())
        text += path_comparison_table(compared.paths) +
                fmt::format("{} samples, {} differ\n", samples.samples, samples.differing);
    print_data(text);
}

int run(const ValidateArguments& arguments, const CommonOptions& common) {
    const Study study = load_study(arguments.study, common);
    const std::vector<const Case*> cases = cases_named(study, arguments.only);
    const auto engine = make_engine(engine_options(common, common.precision == "f64"));
    const std::vector<Precision> wanted = precisions(common, engine->report());
    CasePreparation preparation;
    Compared compared;
    std::set<std::string> warned;
    std::size_t all = 0;
    for (const Case* one : cases)
        all += wanted.size() * ((one->scene.field ? 1 : 0) + (one->scene.paths ? 1 : 0));
    Progress progress("comparisons", all, common.quiet);
    for (const Case* one : cases) {
        PreparedCase prepared = preparation.prepare(*one);
        add_recorded_digest(prepared);
        for (const std::string& warning : prepared.warnings)
            if (warned.insert(warning).second)
                print_warnings({warning}, common);
        for (const Precision precision : wanted) {
            if (one->scene.field)
                compared.fields.push_back(compare_case(*engine, prepared, precision));
            if (one->scene.paths)
                compared.paths.push_back(compare_paths(*engine, prepared, precision));
            progress.update(compared.fields.size() + compared.paths.size(), one->name);
        }
    }
    print(compared, common, engine->report());
    if (!compared.passed() && !common.quiet)
        remark("a bound was exceeded on {}\n", engine->report().device);
    return compared.passed() ? 0 : 1;
}

} // namespace

void add_validate_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto arguments = std::make_shared<ValidateArguments>();
    CLI::App* command = program.add_subcommand(
        "validate", "Hold the device against the CPU oracle and the closed forms, on every voxel and every path");
    command->add_option("SCENE-or-STUDY", arguments->study,
                        "TOML file; without it the paper's study, which is built in");
    command->add_option("--only", arguments->only, "shell pattern of case names");
    command->callback([=, &common, &chosen] { chosen = [=, &common] { return run(*arguments, common); }; });
}

} // namespace forceshade
