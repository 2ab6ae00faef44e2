#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/remark.h"
#include "host/sweep/case_pipeline.h"

namespace forceshade {
namespace {

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
    job.volume = std::filesystem::absolute(volume);
    job.prepared.one.name = volume.stem().string(); // what pictures are headed with
    print_warnings(warnings, common);
    const auto engine = make_engine(engine_options(common, job.prepared.one.scene.precision == Precision::f64));
    job.also = parse_also(arguments.also);
    bool given = false;
    CaseOutcome outcome;
    run_cases(
        *engine, [&] { return std::exchange(given, true) ? nullptr : std::make_unique<CaseJob>(job); }, 1, {},
        [&](const CaseOutcome& ended) { outcome = ended; });
    if (outcome.error)
        std::rethrow_exception(outcome.error);
    const CaseRecord& record = outcome.record;
    if (!common.quiet)
        remark("{}: {} voxels ({} evaluated) on {}, largest force {:.4g} N, error against the oracle in double "
               "precision {:.2g} of it\n",
               arguments.out, record.voxels, record.evaluated, record.engine.device, record.largest_force,
               record.error.relative());
    if (common.json)
        print_data(record_json(record) + "\n");
    return 0;
}

} // namespace

void add_field_command(CLI::App& program, const CommonOptions& common, Command& chosen) {
    const auto arguments = std::make_shared<FieldArguments>();
    CLI::App* command = program.add_subcommand("field", "Evaluate one scene into an EXR volume");
    command->add_option("SCENE", arguments->scene, "scene file (TOML)")->required();
    command->add_option("--out", arguments->out, "the volume, an .exr file")->required();
    command
        ->add_option("--also", arguments->also, "further files beside it: vti (ParaView), npy (NumPy), png (pictures)")
        ->delimiter(',');
    command->callback([=, &common, &chosen] { chosen = [=, &common] { return run(*arguments, common); }; });
}

} // namespace forceshade
