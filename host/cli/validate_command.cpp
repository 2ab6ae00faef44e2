// forceshade validate.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/accuracy/rounding_search.h"
#include "host/cases/path_comparison.h"
#include "host/cli/command.h"
#include "host/long_run.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/referee/validate.h"
#include "host/scene/cases.h"
#include "host/sweep/sweep.h"

namespace forceshade {
namespace {

constexpr std::size_t kSearched = 2000; // places that the search for the worst rounding begins at

struct ValidateArguments {
    std::string study, only = "*";
};

// Single and double precision where the user asks for neither and the device has both.
std::vector<Precision> precisions(const CommonOptions& common, const EngineReport& engine) {
    if (!common.precision.empty())
        return {common.precision == "f64" ? Precision::f64 : Precision::f32};
    if (!engine.f64 && !common.quiet)
        print_note("{} has no double precision: only f32 is validated\n", engine.device);
    return precisions_of(engine);
}

// How far single precision is from double in a case, at its worst.
struct CaseRounding {
    std::string name;
    WorstRounding worst;
};

std::string place_text(const glm::dvec3& place) {
    return fmt::format("({:.4g}, {:.4g}, {:.4g}) mm", 1e3 * place.x, 1e3 * place.y, 1e3 * place.z);
}

// The worst of all cases, of each kind.
std::string rounding_text(const std::vector<CaseRounding>& rounding) {
    std::string text;
    for (const bool same : {true, false}) {
        const CaseRounding* worst = nullptr;
        for (const CaseRounding& one : rounding)
            if (one.worst.same_facet == same && (!worst || one.worst.error > worst->worst.error))
                worst = &one;
        if (worst)
            text += fmt::format("{}: {:.2g} of the largest force, in {} at {}\n",
                                same ? "f32 against f64, the worst that a search found where both meet the same facet"
                                     : "where two facets are equally near and rounding chooses",
                                worst->worst.error, worst->name, place_text(worst->worst.place));
    }
    return text;
}

nlohmann::ordered_json rounding_json(const std::vector<CaseRounding>& rounding) {
    auto json = nlohmann::ordered_json::array();
    for (const CaseRounding& one : rounding)
        json.push_back({{"case", one.name},
                        {"same_facet", one.worst.same_facet},
                        {"error_1", one.worst.error},
                        {"turn_deg", one.worst.turn},
                        {"depth_m", one.worst.depth},
                        {"place_m", {one.worst.place.x, one.worst.place.y, one.worst.place.z}}});
    return json;
}

// Prints the comparisons; true if all passed.
bool print(const std::vector<Comparison>& fields, const std::vector<PathComparison>& paths,
           const std::vector<CaseRounding>& rounding, const CommonOptions& common, const EngineReport& engine) {
    const Totals voxels = totals_of(fields);
    const PathTotals samples = totals_of(paths);
    const bool passed = voxels.passed && samples.passed;
    if (common.json) {
        nlohmann::ordered_json json = nlohmann::ordered_json::parse(comparison_json(fields, engine));
        if (!paths.empty()) {
            json["paths"] = nlohmann::ordered_json::parse(path_comparison_json(paths));
            json["samples"] = samples.samples;
            json["samples_differing"] = samples.differing;
            json["passed"] = passed;
        }
        json["worst_rounding"] = rounding_json(rounding);
        print_data(json.dump(2) + "\n");
        return passed;
    }
    std::string text;
    if (!fields.empty())
        text += comparison_table(fields) + rounding_text(rounding) +
                fmt::format("{} voxels, {} differ\n", voxels.voxels, voxels.differing);
    if (!paths.empty())
        text +=
            path_comparison_table(paths) + fmt::format("{} samples, {} differ\n", samples.samples, samples.differing);
    print_data(text);
    return passed;
}

int run(const ValidateArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const Study study = load_study(arguments.study, common);
    const std::vector<const Case*> cases = cases_named(study, arguments.only);
    const auto engine = make_engine(device_options(common, common.precision == "f64"));
    const std::vector<Precision> wanted = precisions(common, engine->report());
    CasePreparation preparation;
    std::vector<Comparison> fields;
    std::vector<PathComparison> paths;
    std::vector<CaseRounding> rounding;
    std::set<std::string> warned;
    std::size_t all = 0;
    for (const Case* one : cases)
        all += wanted.size() * ((one->scene.field ? 1 : 0) + (one->scene.paths ? 1 : 0));
    Stage stage("preparing", all, "comparisons");
    for (const Case* one : cases) {
        stage.update(fields.size() + paths.size(), one->name);
        PreparedCase prepared = preparation.prepare(*one);
        add_recorded_digest(prepared);
        for (const std::string& warning : prepared.warnings)
            if (warned.insert(warning).second)
                print_warnings({warning}, common);
        if (one->scene.field && std::ranges::count(wanted, Precision::f32) > 0)
            for (const WorstRounding& worst : worst_rounding(prepared, kSearched))
                rounding.push_back({one->name, worst});
        for (const Precision precision : wanted) {
            if (one->scene.field)
                fields.push_back(compare_case(*engine, prepared, precision));
            if (one->scene.paths)
                paths.push_back(compare_paths(*engine, prepared, precision));
            stage.update(fields.size() + paths.size());
        }
    }
    const bool passed = print(fields, paths, rounding, common, engine->report());
    if (!passed && !common.quiet)
        print_note("a bound was exceeded on {}\n", engine->report().device);
    return passed ? 0 : 1;
}

} // namespace

void add_validate_command(CommandLine& program) {
    program.add<ValidateArguments>(
        "validate", "Hold the device against the CPU oracle and the closed forms, on every voxel and every path", run,
        [](Options& options, ValidateArguments& arguments) {
            options.optional("SCENE-or-STUDY", arguments.study,
                             "TOML file; without it the paper's study, which is built in");
            options.optional("--only CASES", arguments.only, "shell pattern of case names").names(case_names);
            options.example("validate bump.toml", "a scene in both precisions")
                .example("validate --only '*600mil_facets-3_*' --gpu 0", "cases of the paper on a device");
        });
}

} // namespace forceshade
