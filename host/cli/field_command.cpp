#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/files.h"
#include "host/paths/path_run.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/referee/validate.h"
#include "host/report/report.h"
#include "host/scene/cases.h"
#include "host/sweep/case_pipeline.h"
#include "host/sweep/sweep.h"

namespace forceshade {

namespace {

// An engine whose rows are counted as they pass: a large field takes long.
class WatchedEngine final : public Engine {
public:
    WatchedEngine(Engine& engine, bool quiet) : engine_(engine), quiet_(quiet) {}
    EngineReport report() const override { return engine_.report(); }
    EngineTimes run(const EngineWork& work) override {
        return std::visit([&](const auto& one) { return watch(one); }, work);
    }

private:
    template <typename T> EngineTimes watch(const FieldWork<T>& work) {
        const layout::FieldInput<T>& input = work.input;
        const bool brief = input.x.size() * input.y.size() * input.z.size() < kWorthWatching;
        Progress progress("layers", input.z.size(), quiet_ || brief);
        return engine_.evaluate(input, [&](const layout::FieldChunk<T>& chunk) {
            work.take(chunk);
            progress.update(chunk.z_first + chunk.z_count, "");
        });
    }
    template <typename T> EngineTimes watch(const PathWork<T>& work) { return engine_.run(work); }

    static constexpr std::size_t kWorthWatching = std::size_t(1) << 24; // voxels: some seconds

    Engine& engine_;
    bool quiet_;
};

struct FieldArguments {
    std::string scene, out;
    std::vector<std::string> also;
};

int run(const FieldArguments& arguments, const CommonOptions& common) {
    const std::filesystem::path volume = arguments.out;
    if (volume.extension() != ".exr")
        throw UsageError(fmt::format("--out {}: a volume is an OpenEXR file, so its name ends in .exr", arguments.out));
    std::vector<std::string> warnings;
    CaseJob job;
    CasePreparation preparation;
    job.prepared = preparation.prepare(read_scene(arguments.scene, overrides(common), &warnings));
    if (!job.prepared.one.scene.field)
        throw UsageError(
            fmt::format("{}: this scene has [paths] and no [grid], so it has no field: add a [grid], or use "
                        "forceshade explore",
                        arguments.scene));
    job.prepared.one.scene.paths.reset(); // they are explore's
    job.volume = std::filesystem::absolute(volume);
    clear_stale_temporaries(job.volume.parent_path());
    job.prepared.one.name = volume.stem().string(); // what pictures are headed with
    warnings.insert(warnings.end(), job.prepared.warnings.begin(), job.prepared.warnings.end());
    print_warnings(warnings, common);
    const auto engine = make_engine(engine_options(common, job.prepared.one.scene.precision == Precision::f64));
    job.also = parse_also(arguments.also);
    bool given = false;
    CaseOutcome outcome;
    WatchedEngine watched(*engine, common.quiet);
    run_cases(
        watched, [&] { return std::exchange(given, true) ? nullptr : std::make_unique<CaseJob>(job); }, 1, {},
        [&](const CaseOutcome& ended) { outcome = ended; });
    if (outcome.error)
        std::rethrow_exception(outcome.error);
    const CaseRecord& record = outcome.record;
    if (!common.quiet)
        remark("{}: {} voxels ({} evaluated) on {}, largest force {:.4g} N, error against the oracle in double "
               "precision {:.2g} of it{}\n",
               arguments.out, record.voxels, record.evaluated, record.engine.device, record.largest_force,
               record.error.relative(),
               record.error.on_edge
                   ? fmt::format(", {} voxels that rounding takes across an edge not counted", record.error.on_edge)
                   : "");
    if (!common.quiet && record.largest_force == 0 && record.error.largest_force > 0)
        remark("warning: the forces, up to {:.3g} N, are too small for the numbers of an EXR volume, which holds 0 "
               "everywhere; with --precision f64, --also npy keeps them\n",
               record.error.largest_force);
    else if (!common.quiet && record.largest_force == 0)
        remark("warning: no voxel of the grid is in contact, so the force is 0 everywhere\n");
    if (common.json)
        print_data(record_json(record) + "\n");
    if (const std::string wrong = complaint(record); !wrong.empty())
        throw Error(ExitCode::failed, wrong);
    return 0;
}

void describe(Options& options, FieldArguments& arguments) {
    options.required("SCENE", arguments.scene, "scene file (TOML)");
    options.required("--out", arguments.out, "the volume, an .exr file");
    options.list("--also", arguments.also, "further files beside it: vti (ParaView), npy (NumPy), png (pictures)");
}

struct SweepArguments {
    std::string study, out, only = "*";
    std::optional<std::string> shard;
    std::vector<std::string> also;
    bool fresh = false, replace = false;
};

std::string as_json(const SweepResult& result, const SweepOptions& options) {
    nlohmann::ordered_json json;
    json["folder"] = options.folder.string();
    json["chosen"] = result.chosen;
    json["computed"] = result.computed;
    json["kept"] = result.kept;
    json["failures"] = result.failures;
    json["voxels_differing_from_oracle"] = result.differing;
    json["samples_differing_from_oracle"] = result.differing_samples;
    json["largest_relative_error"] = result.largest_relative_error;
    json["wall_s"] = result.account.wall;
    json["cpu_s"] = result.account.cpu;
    json["engine_s"] = result.account.engine;
    json["output_s"] = result.account.output;
    json["peak_memory_bytes"] = result.account.peak_memory;
    return json.dump(2) + "\n";
}

bool any_field(const Study& study) {
    return std::ranges::any_of(study.cases, [](const Case& one) { return one.scene.field; });
}

// What --also png leaves, for the last remark.
std::string picture_names(const Study& study) {
    const bool paths = std::ranges::any_of(study.cases, [](const Case& one) { return one.scene.paths.has_value(); });
    return fmt::format("{}{}", any_field(study) ? ", *.arrows.png, *.mosaic.png" : "", paths ? ", *.paths.png" : "");
}

void print_outcome(const SweepResult& result, const SweepOptions& options, const Study& study,
                   const std::filesystem::path& report) {
    if (options.shard)
        remark("shard {}/{}: ", options.shard->index, options.shard->count);
    remark("{} case{}: {} computed{}, {} kept from before{}\n", result.chosen, result.chosen == 1 ? "" : "s",
           result.computed,
           result.computed ? fmt::format(" on {} in {}", result.account.engine_device, clock_text(result.account.wall))
                           : "",
           result.kept, result.failures.empty() ? "" : fmt::format(", {} failed", result.failures.size()));
    if (any_field(study))
        remark("largest error against the oracle in double precision: {:.2g} of the largest force\n",
               result.largest_relative_error);
    const std::filesystem::path folder = std::filesystem::absolute(options.folder).lexically_normal();
    remark("look at {} (in a browser), summary.csv (a row a case), manifest.json (everything known){} and *.exr beside "
           "it\n",
           (folder / report.filename()).string(), options.also.png ? picture_names(study) : "");
}

int run(const SweepArguments& arguments, const CommonOptions& common) {
    if (arguments.out.empty())
        throw UsageError("--out is empty: name a folder, \".\" for the current one");
    SweepOptions options;
    options.folder = arguments.out;
    options.only = arguments.only;
    options.fresh = arguments.fresh;
    options.replace = arguments.replace;
    options.quiet = common.quiet;
    options.also = parse_also(arguments.also);
    options.shard = arguments.shard ? parse_shard(*arguments.shard) : slurm_shard();
    const Study study = load_study(arguments.study, common);
    const EngineOptions engine = engine_options(common, any_f64(study));
    // Also where everything is there already: a device that was asked for must exist, and have computed it.
    if (!common.gpu.empty())
        options.device = compute::choose_device(compute::list_devices(), common.gpu, engine.needs_f64);
    const SweepResult result = [&] {
        try {
            return run_sweep(
                study, [&] { return make_engine(engine); }, engine.cpu, options);
        } catch (const Interrupted&) {
            remark("what was finished stays; the same command goes on from there\n");
            throw;
        }
    }();
    const report::ReportResult report = report::write_report(options.folder);
    if (!common.quiet)
        print_outcome(result, options, study, report.file);
    for (const std::string& failure : result.failures)
        remark("error: {}\n", failure);
    if (common.json)
        print_data(as_json(result, options));
    return result.exit_code;
}

void describe(Options& options, SweepArguments& arguments) {
    options.optional("STUDY", arguments.study, "study file (TOML); without it the paper's study, which is built in");
    options.required("--out", arguments.out, "folder of the results; made if need be");
    options.optional("--only", arguments.only, "shell pattern of case names, for example 'bump*facets-2*'");
    options.optional(
        "--shard", arguments.shard,
        "I/N: do the I-th of N parts, for several machines at once; Slurm's array variables are taken where set");
    options.list("--also", arguments.also, "further files for each case: vti (ParaView), npy (NumPy), png (pictures)");
    options.flag("--fresh", arguments.fresh, "compute anew what is there already");
    options.flag("--replace", arguments.replace,
                 "put this study's summary, manifest and report in the place of another study's, whose cases it "
                 "does not all have; volumes stay");
}

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

void describe(Options& options, ValidateArguments& arguments) {
    options.optional("SCENE-or-STUDY", arguments.study, "TOML file; without it the paper's study, which is built in");
    options.optional("--only", arguments.only, "shell pattern of case names");
}

} // namespace

void add_field_command(CommandLine& program) {
    program.add<FieldArguments>("field", "Evaluate one scene into an EXR volume", run, describe);
}

void add_sweep_command(CommandLine& program) {
    program.add<SweepArguments>(
        "sweep", "Evaluate every case of a study into a folder; run again to finish or repair it", run, describe);
}

void add_validate_command(CommandLine& program) {
    program.add<ValidateArguments>(
        "validate", "Hold the device against the CPU oracle and the closed forms, on every voxel and every path", run,
        describe);
}

} // namespace forceshade
