#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include "host/cli/command.h"
#include "host/error.h"
#include "host/io/temporary_file.h"
#include "host/remark.h"
#include "host/sweep/case_pipeline.h"
#include "host/sweep/progress.h"

namespace forceshade {
namespace {

// An engine whose rows are counted as they pass: a large field takes long.
class WatchedEngine final : public Engine {
public:
    WatchedEngine(Engine& engine, bool quiet) : engine_(engine), quiet_(quiet) {}
    EngineReport report() const override { return engine_.report(); }
    EngineTimes evaluate(const layout::FieldInput<float>& input,
                         const std::function<void(const layout::FieldChunk<float>&)>& consume) override {
        return watch(input, consume);
    }
    EngineTimes evaluate(const layout::FieldInput<double>& input,
                         const std::function<void(const layout::FieldChunk<double>&)>& consume) override {
        return watch(input, consume);
    }

private:
    template <typename T>
    EngineTimes watch(const layout::FieldInput<T>& input,
                      const std::function<void(const layout::FieldChunk<T>&)>& consume) {
        const bool brief = input.x.size() * input.y.size() * input.z.size() < kWorthWatching;
        Progress progress("layers", input.z.size(), quiet_ || brief);
        return engine_.evaluate(input, [&](const layout::FieldChunk<T>& chunk) {
            consume(chunk);
            progress.update(chunk.z_first + chunk.z_count, "");
        });
    }

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
