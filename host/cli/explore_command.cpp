#include <algorithm>
#include <future>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/cases/case_pipeline.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/field/comparison.h"
#include "host/field/prepared_case.h"
#include "host/limits/limits.h"
#include "host/long_run.h"
#include "host/numbers.h"
#include "host/output/files.h"
#include "host/output/json.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/report/report.h"
#include "host/threads.h"

namespace forceshade {
namespace {

struct ExploreArguments {
    std::string scene, paths, out, renderer;
    std::vector<std::string> also;
    picture::Look look;
    bool metrics_only = false, open_loop = false;

    std::filesystem::path stem() const {
        const std::filesystem::path file = std::filesystem::absolute(out);
        return file.parent_path() / file.stem();
    }
    std::filesystem::path summary() const { return stem().string() + ".paths.csv"; }
};

void check(const ExploreArguments& arguments, const std::string& recorded) {
    const std::string extension = std::filesystem::path(arguments.out).extension().string();
    if (extension != ".csv" && extension != ".exr" && extension != ".npy")
        throw UsageError("--out {}: explored paths are an OpenEXR or a CSV file or NumPy arrays, so its name ends in "
                         ".exr, .csv or .npy",
                         arguments.out);
    const std::string name = "--out " + arguments.out;
    refuse_replacing({{name, arguments.out}, {name, arguments.summary()}}, {recorded, arguments.scene});
    if (extension == ".npy" && std::ranges::count(arguments.also, "html") > 0)
        throw UsageError("--also html draws what an EXR or a CSV file holds: write --out {}.exr --also npy,html",
                         arguments.stem().filename().string());
    if (arguments.metrics_only && !arguments.also.empty())
        throw UsageError("--metrics-only and --also exclude each other: there are no samples then");
}

double share(std::uint64_t part, std::uint64_t whole) {
    return whole > 0 ? double(part) / double(whole) : 0;
}

// With the channels that the samples have.
Scene paths_alone(const PathRunOptions& options, Scene scene) {
    scene.field = false;
    scene.output.channels = computed_channels(options, scene.output.channels);
    return scene;
}

std::string as_json(const PathRecord& record, const ExploreArguments& arguments, const EngineReport& engine,
                    const Scene& paths) {
    nlohmann::ordered_json json;
    json["out"] = arguments.metrics_only ? nlohmann::ordered_json() : nlohmann::ordered_json(arguments.out);
    json["files"] = record.files;
    json["engine"] = {{"kind", engine.engine}, {"device", engine.device}, {"driver", engine.driver}};
    json.update(paths_json(record));
    json["omitted"] = omissions(paths);
    json["contact_share"] = share(record.in_contact, record.samples);
    json["steps_per_second"] = record.steps_per_second();
    return json.dump(2) + "\n";
}

void print_outcome(const PathRecord& record, const std::string& out, const EngineReport& engine,
                   const PathRunOptions& options, const Scene& scene) {
    print_note("{}: {} of {} on {}, {:.3g} million steps/s, {:.3g} % in contact, {} unstable, largest force {:.4g} N, "
               "work {:.4g} J, depth {:.4g} m, {:.2g} m (RMS) about it{}\n",
               out, numbers::counted(record.paths, "path"), numbers::counted(record.steps, "step"), engine.device,
               record.steps_per_second() / 1e6, 100 * share(record.in_contact, record.samples), record.unstable,
               record.largest_force, record.work, record.mean_depth, record.depth_deviation,
               record.error.paths == 0 ? ""
                                       : fmt::format("; {} of {} compared with the oracle, {} differ",
                                                     record.error.paths, numbers::counted(record.paths, "path"),
                                                     record.error.differing + record.error.metrics));
    const bool is_studied = scene.paths && scene.paths->kind != PathKind::recorded;
    print_note("{}{}\n", left_out_text(paths_alone(options, scene)),
               is_studied ? " (what that saves: forceshade study omission SCENE)" : "");
    if (record.deviation)
        print_note("{}", deviation_text(*record.deviation));
    constexpr double kHardly = 0.1; // of the samples
    const bool mesh = scene.surface.kind == SurfaceKind::mesh;
    const bool followed = scene.paths && scene.paths->follow == PathFollow::surface;
    if (share(record.in_contact, record.samples) < kHardly && (scene.paths || record.in_contact == 0))
        print_note("warning: {} in contact{}\n",
                   record.in_contact == 0 ? std::string("no sample is")
                                          : fmt::format("only {:.2g} % of the samples are",
                                                        100 * share(record.in_contact, record.samples)),
                   !mesh || followed || !scene.paths
                       ? "; go deeper, or press"
                       : ": depth counts from the top of the mesh's box; follow = \"surface\" under [paths] counts it "
                         "straight down from the surface, which is less along its normal where it slopes");
    // Those that follow a surface below it are meant to.
    if (record.began_inside > 0 && !followed)
        print_note(
            "warning: {} of {} begin behind the mesh's surface; their proxies begin at the nearest place of it\n",
            record.began_inside, numbers::counted(record.paths, "path"));
    if (record.unstable > 0)
        print_note("warning: {} of {} left the bound round their target and are flagged unstable{}\n", record.unstable,
                   numbers::counted(record.paths, "path"),
                   record.fell > 0 ? fmt::format(", {} of them fell off the surface", record.fell) : "");
}

std::vector<std::filesystem::path> all_files(const PathRunOptions& options, const Scene& scene,
                                             const std::filesystem::path& page) {
    std::vector<std::filesystem::path> files;
    for (const std::string& name : path_file_names(options, written_channels(scene)))
        files.push_back(options.stem.parent_path() / name);
    if (!page.empty())
        files.push_back(page);
    return files;
}

int run_all(const ExploreArguments& arguments, const CommonOptions& common, const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    const bool closed = scene.paths && scene.paths->closed();
    // While a device opens.
    std::future<std::string> warning = std::async(closed ? std::launch::async : std::launch::deferred, [&] {
        return closed ? scene_limits(prepared).warning() : std::string();
    });
    const auto engine = make_engine(arguments.renderer, prepared, common, path_workload(scene, arguments.paths));
    if (const std::string limit = warning.get(); !limit.empty())
        print_warnings({limit}, common);
    PathRunOptions options;
    options.stem = arguments.stem();
    if (!arguments.metrics_only)
        options.samples = std::filesystem::absolute(arguments.out);
    if (!arguments.paths.empty())
        options.recorded = arguments.paths;
    options.threads = static_cast<int>(most_threads());
    std::filesystem::path page;
    for (const std::string& name : arguments.also)
        if (name == "html")
            page = options.stem.string() + ".html";
        else if (name == "vti" || !options.also.add(name))
            throw UsageError(
                "--also {}: for paths there are vtp, npy, html, png, svg and pdf, with commas between them", name);
    options.look = arguments.look;
    if (!may_write(all_files(options, scene, page), common))
        return 0;
    refuse_unused(options.also.pictures, arguments.look == picture::Look{});
    clear_stale_temporaries(options.stem.parent_path());
    const PathRecord record = run_paths(*engine, prepared, options);
    if (!page.empty()) {
        const Stage stage("writing " + page.filename().string());
        study::StudyData data;
        report::add_samples(data, options.samples);
        write_file_atomically(page,
                              report::run_page(arguments.scene + ", explored", {{"Samples", arguments.out}}, data));
    }
    print_stage_times(record.engine_times, record.volume_times);
    const std::string out = arguments.metrics_only ? arguments.summary().filename().string() : arguments.out;
    print_warnings(record.warnings, common);
    if (!common.quiet)
        print_outcome(record, out, engine->report(), options, scene);
    note(common, "wrote {}{}\n", names_of(record.files), page.empty() ? "" : ", " + page.filename().string());
    if (common.json)
        print_data(as_json(record, arguments, engine->report(), paths_alone(options, scene)));
    if (const std::string wrong = error_text(record, out, engine->report().device);
        !wrong.empty() && arguments.renderer.empty())
        throw Error(ExitCode::failed, wrong);
    return 0;
}

// The scene as a law alone: positions of a file are where the probe was, not where a hand wanted it to be.
void leave_out_the_hand(Case& one) {
    one.scene.paths.reset();
    std::erase_if(one.settings,
                  [](const Setting& setting) { return setting.table == "paths" || setting.table == "hand"; });
}

int run(const ExploreArguments& arguments, const CommonOptions& common) {
    const LongRun long_run(common.quiet);
    CasePreparation preparation;
    Case one = load_scene(arguments.scene, common);
    if (arguments.open_loop) {
        if (arguments.paths.empty())
            throw UsageError("--open-loop takes the positions of --paths for the probe's: say which file");
        leave_out_the_hand(one);
    }
    const std::optional<PathsSpec>& paths = one.scene.paths;
    const bool in_scene = paths && paths->kind == PathKind::recorded;
    const std::string recorded = !arguments.paths.empty() ? arguments.paths : in_scene ? paths->path : "";
    check(arguments, recorded);
    if (recorded.empty() && !paths)
        throw UsageError("{}: the probe has no path: add a [paths] table, or give --paths with a CSV file of positions",
                         arguments.scene);
    device_options(common, false); // refuses --gpu with --engine cpu
    PreparedCase prepared = prepare_scene(preparation, std::move(one), common);
    if (arguments.paths.empty())
        add_recorded_digest(prepared);
    prepared.one.name = std::filesystem::path(arguments.out).stem().string(); // the record's
    const Scene& scene = prepared.one.scene;
    if (prepared.images.mesh)
        print_warnings(warnings_of(scene.surface.mesh, *prepared.images.mesh, MeshUse::path), common);
    return run_all(arguments, common, prepared);
}

void describe(Options& options, ExploreArguments& arguments) {
    options.required("SCENE", arguments.scene,
                     "scene file (TOML) with [paths], unless --paths is given; needs no [grid]");
    options.optional("--paths FILE", arguments.paths,
                     "recorded positions in place of the scene's: a CSV file with a header and columns path, t, x, y, "
                     "z (s, m), of a single path t, x, y, z; others are not read, and times of a path increase");
    options.required("--out FILE", arguments.out,
                     "OUT.exr (a row a path), OUT.csv (a line a sample) or OUT.npy (arrays alone, one a file: "
                     "OUT.force.npy and others); OUT.paths.csv next to it has a line a path");
    options.list("--also vtp|npy|html|png|svg|pdf", arguments.also,
                 "further files next to it: vtp (ParaView); npy (NumPy); html (force and position over time and "
                 "place); png, svg, pdf (paths over the surface, direction of the force)");
    describe_look(options, arguments.look);
    options.flag("--open-loop", arguments.open_loop,
                 "the positions of --paths are the probe's own, as in the log of a live loop, even if the scene's "
                 "paths are a closed loop");
    options.flag("--metrics-only", arguments.metrics_only, "no samples, only OUT.paths.csv");
    describe_renderer(options, arguments.renderer);
    options.example("explore strokes.toml --out felt.csv --also png", "the paths that a scene describes, drawn, too")
        .example("explore bump.toml --paths felt.csv --open-loop --engine cpu --precision f64 -o again.csv",
                 "the same law along recorded positions");
}

} // namespace

void add_explore_command(CommandLine& program) {
    program.add<ExploreArguments>("explore", "Take probes along a scene's paths and write the forces on them", run,
                                  describe);
}

} // namespace forceshade
