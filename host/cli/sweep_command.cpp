#include <CLI/CLI.hpp>
#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "compute/device.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/interrupt.h"
#include "host/remark.h"
#include "host/report/report.h"
#include "host/sweep/progress.h"
#include "host/sweep/sweep.h"

namespace forceshade {
namespace {

struct SweepArguments {
    std::string study, out, only = "*";
    std::optional<std::string> shard;
    std::vector<std::string> also;
    bool fresh = false;
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

} // namespace

void add_sweep_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto arguments = std::make_shared<SweepArguments>();
    CLI::App* command = program.add_subcommand(
        "sweep", "Evaluate every case of a study into a folder; run again to finish or repair it");
    command->add_option("STUDY", arguments->study,
                        "study file (TOML); without it the paper's study, which is built in");
    command->add_option("--out", arguments->out, "folder of the results; made if need be")->required();
    command->add_option("--only", arguments->only, "shell pattern of case names, for example 'bump*facets-2*'");
    command->add_option(
        "--shard", arguments->shard,
        "I/N: do the I-th of N parts, for several machines at once; Slurm's array variables are taken where set");
    command
        ->add_option("--also", arguments->also,
                     "further files for each case: vti (ParaView), npy (NumPy), png (pictures)")
        ->delimiter(',');
    command->add_flag("--fresh", arguments->fresh, "compute anew what is there already");
    command->callback([=, &common, &chosen] { chosen = [=, &common] { return run(*arguments, common); }; });
}

} // namespace forceshade
