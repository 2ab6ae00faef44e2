// forceshade validate.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/accuracy/accuracy.h"
#include "host/cases/path_comparison.h"
#include "host/cli/command.h"
#include "host/long_run.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/referee/validate.h"
#include "host/renderer/renderer_engine.h"
#include "host/scene/cases.h"
#include "host/sweep/sweep.h"

namespace forceshade {
namespace {

constexpr std::size_t kSearched = 20000; // places that the search for the worst rounding begins at

struct ValidateArguments {
    std::string study, only = "*", renderer;
};

// With a note where one is missing.
std::vector<Precision> precisions(const CommonOptions& common, const EngineReport& engine) {
    if (common.precision.empty() && !engine.f64)
        note(common, "{} has no double precision: only f32 is validated\n", engine.device);
    return precisions_of(common, engine.f64);
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

// What was found on a device.
struct Findings {
    EngineReport engine;
    std::vector<Comparison> fields;
    std::vector<PathComparison> paths;

    bool passed() const { return totals_of(fields).passed && totals_of(paths).passed; }
};

nlohmann::ordered_json json_of(const Findings& found, const std::vector<CaseRounding>& rounding) {
    nlohmann::ordered_json json = nlohmann::ordered_json::parse(comparison_json(found.fields, found.engine));
    if (!found.paths.empty()) {
        const Totals samples = totals_of(found.paths);
        json["paths"] = nlohmann::ordered_json::parse(path_comparison_json(found.paths));
        json["samples"] = samples.compared;
        json["samples_differing"] = samples.differing;
        json["passed"] = found.passed();
    }
    json["worst_rounding"] = rounding_json(rounding);
    return json;
}

std::string text_of(const Findings& found, const std::vector<CaseRounding>& rounding) {
    const Totals voxels = totals_of(found.fields);
    const Totals samples = totals_of(found.paths);
    std::string text;
    if (!found.fields.empty())
        text += comparison_table(found.fields) + rounding_text(rounding) +
                fmt::format("{} voxels, {} differ\n", voxels.compared, voxels.differing);
    if (!found.paths.empty())
        text += path_comparison_table(found.paths) +
                fmt::format("{} samples, {} differ\n", samples.compared, samples.differing);
    return text;
}

// A line for each of several devices.
std::string overview(const std::vector<Findings>& all) {
    std::string text;
    for (const Findings& found : all) {
        const Totals voxels = totals_of(found.fields);
        const Totals samples = totals_of(found.paths);
        text += fmt::format("{}, {}, {}: {} values, {} differ: {}\n", found.engine.device, found.engine.driver,
                            found.engine.f64 ? "f32 and f64" : "f32", voxels.compared + samples.compared,
                            voxels.differing + samples.differing, found.passed() ? "ok" : "FAILED");
    }
    return text;
}

// `each`: of every device, however few there are.
void print(const std::vector<Findings>& all, const std::vector<CaseRounding>& rounding, bool each, bool json) {
    if (json && !each) {
        print_data(json_of(all.front(), rounding).dump(2) + "\n");
    } else if (json) {
        nlohmann::ordered_json devices = nlohmann::ordered_json::array();
        for (const Findings& found : all)
            devices.push_back(json_of(found, rounding));
        print_data(nlohmann::ordered_json{{"devices", devices}}.dump(2) + "\n");
    } else if (!each) {
        print_data(text_of(all.front(), rounding));
    } else {
        for (const Findings& found : all)
            print_data(fmt::format("{}\n{}\n", found.engine.device, text_of(found, rounding)));
        print_data(overview(all));
    }
}

// The device that is asked for; with --gpu all each that can be used. One is open at a time.
std::vector<EngineOptions> devices(const CommonOptions& common) {
    const bool needs_f64 = common.precision == "f64";
    std::vector<EngineOptions> all(1, device_options(common, needs_f64));
    all.front().twice = true;
    if (common.gpu != "all")
        return all;
    const EngineOptions one = all.front();
    all.clear();
    for (const compute::DeviceReport& device : compute::list_devices())
        if (device.refusals.empty() && (device.f64 || !needs_f64)) {
            all.push_back(one);
            all.back().gpu = std::to_string(device.index);
        } else {
            print_note("{} is left out: {}\n", device.name,
                       device.refusals.empty() ? "no double precision" : device.refusals.front());
        }
    if (all.empty())
        throw compute::DeviceError(compute::DeviceError::Kind::no_such_device,
                                   "no usable Vulkan device: forceshade gpus says why");
    return all;
}

// What `compare` finds. Where the device's results depend on how work is cut, that is the finding; other cases and
// devices go on.
template <typename Compare> auto found_by(const Compare& compare, const std::string& name, Precision precision) {
    try {
        return compare();
    } catch (const compute::DeviceError& error) {
        if (error.kind() != compute::DeviceError::Kind::differs_in_parts)
            throw;
        decltype(compare()) failed{};
        failed.name = name;
        failed.precision = precision;
        if constexpr (requires { failed.first_difference; })
            failed.first_difference = error.what();
        else
            failed.error.first = error.what();
        return failed;
    }
}

// By a device, or a renderer, which is opened for each case. `rounding`: null where it was searched for before.
Findings findings_on(const EngineOptions& options, const std::optional<RendererSource>& renderer,
                     const std::vector<const Case*>& cases, const CommonOptions& common,
                     std::vector<CaseRounding>* rounding) {
    std::unique_ptr<Engine> engine = renderer ? nullptr : make_engine(options);
    Findings found{renderer ? EngineReport{"renderer", renderer->name, "", "", false, true} : engine->report(), {}, {}};
    const std::vector<Precision> wanted =
        renderer && common.precision.empty() ? std::vector{Precision::f64} : precisions(common, found.engine);
    CasePreparation preparation;
    std::set<std::string> warned;
    std::size_t all = 0;
    const auto walks = [](const Case& one) { return one.scene.paths && !one.scene.rubs(); };
    for (const Case* one : cases) {
        all += wanted.size() * ((one->scene.field ? 1 : 0) + (walks(*one) ? 1 : 0));
        if (rounding && one->scene.paths && !walks(*one))
            note(common, "{}: its paths are left out: friction and vibration run on the CPU oracle alone\n", one->name);
    }
    Stage stage("preparing", all, "comparisons");
    for (const Case* one : cases) {
        stage.update(found.fields.size() + found.paths.size(), one->name);
        PreparedCase prepared = preparation.prepare(*one);
        add_recorded_digest(prepared);
        if (renderer)
            engine = make_renderer_engine(*renderer, prepared);
        for (const std::string& warning : prepared.warnings)
            if (rounding && warned.insert(warning).second)
                print_warnings({warning}, common);
        if (rounding && one->scene.field && std::ranges::count(wanted, Precision::f32) > 0)
            for (const WorstRounding& worst : worst_rounding(prepared, kSearched))
                rounding->push_back({one->name, worst});
        for (const Precision precision : wanted) {
            if (one->scene.field)
                found.fields.push_back(
                    found_by([&] { return compare_case(*engine, prepared, precision); }, one->name, precision));
            if (walks(*one))
                found.paths.push_back(
                    found_by([&] { return compare_paths(*engine, prepared, precision); }, one->name, precision));
            stage.update(found.fields.size() + found.paths.size());
        }
    }
    return found;
}

int run(const ValidateArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const Study study = load_study(arguments.study, common);
    const std::vector<const Case*> cases = cases_named(study, arguments.only);
    std::vector<Findings> all;
    std::vector<CaseRounding> rounding;
    if (!arguments.renderer.empty()) {
        refuse_engine(common);
        all.push_back(findings_on({}, parse_renderer(arguments.renderer), cases, common, &rounding));
    } else
        for (const EngineOptions& options : devices(common))
            all.push_back(findings_on(options, std::nullopt, cases, common, all.empty() ? &rounding : nullptr));
    print(all, rounding, common.gpu == "all", common.json);
    bool passed = true;
    for (const Findings& found : all) {
        passed = passed && found.passed();
        if (!found.passed())
            note(common, "a comparison failed on {}\n", found.engine.device);
    }
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
            options.optional("--renderer LIBRARY[:OPTIONS]", arguments.renderer,
                             "in place of a device: a shared library of your own (forceshade_renderer.h)");
            options.example("validate bump.toml", "a scene in both precisions")
                .example("validate --only '*600mil_facets-3_*' --gpu 0", "cases of the paper on a device")
                .example("validate bump.toml --gpu all",
                         "on every Vulkan device that can be used, with a line for each");
        });
}

} // namespace forceshade
