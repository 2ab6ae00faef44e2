// forceshade sweep.
#include <algorithm>
#include <chrono>
#include <span>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/cases/case_files.h"
#include "host/cases/case_pipeline.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/long_run.h"
#include "host/numbers.h"
#include "host/program.h"
#include "host/report/report.h"
#include "host/sweep/sweep.h"

namespace forceshade {
namespace {

struct SweepArguments {
    std::string study, out, status, only = "*";
    std::optional<std::string> shard;
    std::vector<std::string> also;
    bool fresh = false, replace = false, list = false, dry = false, merge = false, verify = false;
};

constexpr const char* kGoOn = "finished cases are kept; run the same command to resume";

// Folders may have names that are not UTF-8.
std::string json_text(const nlohmann::ordered_json& json) {
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

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
    return json_text(json);
}

std::string case_list(const Study& study, bool json) {
    std::string text;
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const Case& one : study.cases) {
        text += one.name + "\n";
        list.push_back({{"name", one.name}, {"parameters", nlohmann::ordered_json::object()}});
        for (const auto& [key, value] : one.varied)
            list.back()["parameters"][key] = value;
    }
    return json ? json_text(list) : text;
}

std::string forecast_text(const SweepResult& result, const SweepOptions& options, bool as_json) {
    const Forecast& needed = result.forecast;
    const std::size_t missing = result.chosen - result.kept;
    const double free = free_bytes(options.folder);
    if (as_json)
        return json_text({{"folder", options.folder.string()},
                          {"chosen", result.chosen},
                          {"kept", result.kept},
                          {"to_compute", missing},
                          {"voxels", needed.voxels},
                          {"path_samples", needed.samples},
                          {"expected_bytes", needed.bytes.value_or(0)},
                          {"least_bytes", needed.least_bytes},
                          {"most_bytes", needed.most_bytes},
                          {"free_bytes", free},
                          {"expected_s", needed.seconds.value_or(0)}});
    std::string text =
        fmt::format("cases    {}: {} there already, {} to compute\n", result.chosen, result.kept, missing);
    if (missing == 0)
        return text;
    text += fmt::format("voxels   {:.0f}\n", needed.voxels);
    if (needed.samples > 0)
        text += fmt::format("samples  {:.0f} of paths\n", needed.samples);
    text += fmt::format("on disk  about {}, between {} and {}; {} are free{}\n", numbers::size_text(*needed.bytes),
                        numbers::size_text(needed.least_bytes), numbers::size_text(needed.most_bytes),
                        numbers::size_text(free),
                        needed.least_bytes > free ? ": that cannot fit"
                        : *needed.bytes > free    ? ": too few"
                                                  : "");
    return text + fmt::format("time     about {:.2g} min\n", *needed.seconds / 60);
}

template <typename Has> bool any_case(const Study& study, Has&& has) {
    return std::ranges::any_of(study.cases, [&](const Case& one) { return has(one.scene); });
}

void print_outcome(const SweepResult& result, const SweepOptions& options, const Study& study,
                   const std::filesystem::path& report) {
    if (options.shard)
        print_note("shard {}/{}: ", options.shard->index, options.shard->count);
    print_note("{}: {} computed{}, {} kept from before{}\n", numbers::counted(result.chosen, "case"), result.computed,
               result.computed
                   ? fmt::format(" on {} in {}", result.account.engine_device, clock_text(result.account.wall))
                   : "",
               result.kept, result.failures.empty() ? "" : fmt::format(", {} failed", result.failures.size()));
    const bool fields = any_case(study, [](const Scene& scene) { return scene.field; });
    const bool paths = any_case(study, [](const Scene& scene) { return scene.paths.has_value(); });
    if (result.evaluated < result.voxels)
        print_note("left out: {0:.3g} % of {1} voxels, which are {2}; modelled, that saves {0:.3g} % of computing; "
                   "summary.csv says "
                   "what else\n",
                   100 - 100 * double(result.evaluated) / double(result.voxels), result.voxels,
                   result.free_space ? "alike or in free space" : "alike along y");
    for (const std::string& warning : result.warnings)
        print_note("warning: {}\n", warning);
    if (!result.untouched.empty())
        print_note("warning: {} of {} without any force, since no voxel of their grids is in contact: {}{}\n",
                   result.untouched.size(), numbers::counted(result.chosen, "case"), *result.untouched.begin(),
                   result.untouched.size() > 1 ? ", ..." : "");
    if (fields)
        print_note("largest error against the oracle in double precision: {:.2g} of the largest force\n",
                   result.largest_relative_error);
    const std::filesystem::path folder = std::filesystem::absolute(options.folder).lexically_normal();
    if (options.shard) {
        print_note("when all shards have ended: the same command with --merge in place of --shard\n");
        return;
    }
    print_note(
        "look at {} (in a browser), summary.csv (a row a case), manifest.json (all records){}{} and *.exr next to it\n",
        (folder / report.filename()).string(), options.also.pictures.any() && fields ? ", *.arrows.*, *.stroke.*" : "",
        options.also.pictures.any() && paths ? ", *.paths.*" : "");
}

int print_status(const SweepArguments& arguments, const CommonOptions& common) {
    if (!std::filesystem::is_directory(arguments.status))
        throw IoError(arguments.status + ": there is no such folder");
    const std::vector<ShardNote> notes = read_notes(arguments.status);
    if (notes.empty())
        throw UsageError(arguments.status + ": no shard status files in this folder (written by sweep --shard)");
    const double now = std::chrono::duration<double>(std::chrono::system_clock::now().time_since_epoch()).count();
    print_data(common.json ? status_json(notes, now) : status_text(notes, now));
    return 0;
}

std::string as_json(const MergeResult& result) {
    return json_text({{"cases", result.cases},
                      {"recorded", result.recorded},
                      {"missing", result.missing},
                      {"of_other_scenes_or_programs", result.others},
                      {"shards", result.shards},
                      {"failures", result.failures},
                      {"beyond_bound", result.wrong}});
}

void print_errors(const std::vector<std::string>& errors) {
    constexpr std::size_t kMost = 50;
    for (std::size_t i = 0; i < std::min(kMost, errors.size()); ++i)
        print_note("error: {}\n", errors[i]);
    if (errors.size() > kMost)
        print_note("error: and {} more like these\n", errors.size() - kMost);
}

// 1 where something is missing or wrong.
int merge(const SweepArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    const MergeResult result =
        merge_sweep(load_study(arguments.study, common), {arguments.out, arguments.verify, arguments.replace});
    const std::filesystem::path report = result.recorded > 0 ? report::write_report(arguments.out).file : "";
    note(common, "{} of {} recorded{}\n", result.recorded, numbers::counted(result.cases, "case"),
         report.empty() ? "" : "; look at " + full_path(report));
    if (result.temporaries > 0)
        note(common, "{} of other machines, .*.tmp: once no shard is at work, they can be removed\n",
             numbers::counted(result.temporaries, "temporary file"));
    print_errors(result.failures);
    print_errors(result.wrong);
    if (!result.missing.empty()) {
        constexpr std::size_t kMost = 5;
        const std::span<const std::string> first(result.missing.data(), std::min(kMost, result.missing.size()));
        print_note("error: {} missing: {}{}\n", numbers::counted(result.missing.size(), "case"), fmt::join(first, ", "),
                   first.size() < result.missing.size() ? " ..." : "");
        if (result.others > 0)
            print_note("error: {} of them have records of another scene, other files or another program: give --merge "
                       "the study and the flags that the shards have, and run all with the same program\n",
                       result.others);
        if (!result.shards.empty())
            print_note("error: run again: --shard {}\n", fmt::join(result.shards, ", --shard "));
    }
    if (common.json)
        print_data(as_json(result));
    return result.missing.empty() && result.wrong.empty() ? 0 : 1;
}

int run(const SweepArguments& arguments, const CommonOptions& common) {
    if (!arguments.status.empty())
        return print_status(arguments, common);
    if (arguments.out.empty() && !arguments.list)
        throw UsageError("--out is required: name a folder, \".\" for the current one");
    if (arguments.verify && !arguments.merge)
        throw UsageError("--verify goes with --merge: a sweep verifies what it finds by itself");
    if (arguments.merge &&
        (arguments.shard || arguments.only != "*" || arguments.fresh || arguments.dry || !arguments.also.empty()))
        throw UsageError("--merge cannot be combined with --shard, --only, --fresh, --dry-run, --also");
    if (arguments.merge)
        return merge(arguments, common);
    const LongRun long_run(common.quiet, arguments.dry ? "" : kGoOn);
    SweepOptions options;
    options.dry = arguments.dry;
    options.folder = arguments.out;
    options.only = arguments.only;
    options.fresh = arguments.fresh;
    options.replace = arguments.replace;
    options.quiet = common.quiet;
    options.also = parse_also(arguments.also);
    options.any_engine = common.engine == "auto" && common.gpu.empty();
    if (arguments.shard)
        options.shard = parse_shard(*arguments.shard);
    else if (!arguments.list && !arguments.dry)
        require_whole();
    const bool part = options.shard || arguments.list;
    const Shard shard = options.shard.value_or(Shard{});
    const Study study =
        load_study(arguments.study, common, part ? CaseChoice{arguments.only, shard.index, shard.count} : CaseChoice{});
    if (arguments.list) {
        print_data(case_list(study, common.json));
        return 0;
    }
    const SelectedEngine engine =
        select_engine(common, any_case(study, [](const Scene& scene) { return scene.precision == Precision::f64; }),
                      study_workload(study));
    // Also where everything is there already: a device that was asked for must exist, and have computed it.
    if (!common.gpu.empty())
        options.device = compute::choose_device(compute::list_devices(), common.gpu, engine.options.needs_f64);
    const auto sweep = [&] {
        try {
            return run_sweep(
                study, [&] { return make_engine(engine, common); }, engine.options.cpu, options);
        } catch (const Interrupted&) {
            print_note("{}\n", kGoOn);
            throw;
        }
    };
    const SweepResult result = sweep();
    if (options.dry) {
        print_data(forecast_text(result, options, common.json));
        return 0;
    }
    const std::filesystem::path report = options.shard ? "" : report::write_report(options.folder).file;
    if (!common.quiet)
        print_outcome(result, options, study, report);
    for (const std::string& failure : result.failures)
        print_note("error: {}\n", failure);
    if (common.json)
        print_data(as_json(result, options));
    return result.exit_code;
}

void describe(Options& options, SweepArguments& arguments) {
    options.optional("STUDY", arguments.study, "study file (TOML); without it the paper's study, which is built in");
    options.optional("--out DIR", arguments.out, "folder of the results; made if need be");
    options.flag("--list", arguments.list, "only print the names of the cases (with --json also what varies)");
    options.flag("--dry-run", arguments.dry,
                 "only print how many cases are to be computed, and what voxels, bytes and minutes they take, from "
                 "small copies of some");
    options.optional("--only CASES", arguments.only, "shell pattern of case names, for example 'bump*facets-2*'")
        .names(case_names);
    options.optional("--shard I/N", arguments.shard,
                     "do the I-th of N parts, for several machines at once, and write volumes and records alone; "
                     "\"slurm\": the part that a task of a Slurm array 1-N or of an srun is");
    options.flag("--merge", arguments.merge,
                 "do not compute: make manifest, summary and report from what the shards wrote; exits with 1 and lists "
                 "the cases that are missing, if any");
    options.flag("--verify", arguments.verify, "with --merge: hash every file, instead of looking at its size");
    options.optional("--status DIR", arguments.status,
                     "do not compute: print the status of the shards that write into DIR");
    options.list("--also vti|vtp|npy|png|svg|pdf", arguments.also,
                 "further files for each case: vti (ParaView: the field), vtp (ParaView: the surface with the forces "
                 "on it, the paths as lines), npy (NumPy), png, svg, pdf (pictures)");
    options.flag("--fresh", arguments.fresh, "compute anew what is there already");
    options.flag("--replace", arguments.replace,
                 "put this study's summary, manifest and report in the place of another study's, whose cases it does "
                 "not all have; volumes stay");
    options
        .example("sweep --out bumps --only '*600mil_facets-[1-3]_*' --also png",
                 "some cases of the paper's study, with pictures")
        .example("sweep study.toml -o results --engine cpu", "a study of your own")
        .example("sweep study.toml -o results --shard 3/8", "its third of eight parts; then the same with --merge");
}

} // namespace

void add_sweep_command(CommandLine& program) {
    program.add<SweepArguments>(
        "sweep", "Evaluate every case of a study into a folder; run again to finish or repair it", run, describe);
}

} // namespace forceshade
