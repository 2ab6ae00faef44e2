#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <optional>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/run_report/report.h"
#include "device/session/session.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/field/mesh_cache.h"
#include "host/field/prepared_case.h"
#include "host/output/files.h"
#include "host/renderer/renderer_process.h"
#include "host/scene/document.h"
#include "host/scene/schema.h"
#include "host/scene/study.h"

namespace forceshade {

namespace {

struct LiveArguments {
    std::string scene, log, report, renderer;
    bool fast = false, view = false;
    std::optional<int> port;
    DeviceArguments device;
};

// STEM of the report: as on the command line, or next to the log if that is a regular file; empty: none.
std::filesystem::path report_stem(const LiveArguments& arguments) {
    if (!arguments.report.empty())
        return std::filesystem::absolute(arguments.report);
    if (arguments.log.empty())
        return {};
    const std::filesystem::path log = std::filesystem::absolute(arguments.log);
    std::error_code ignored;
    if (std::filesystem::exists(log, ignored) && !std::filesystem::is_regular_file(log, ignored))
        return {}; // not into the folder of /dev/null
    return log.parent_path() / (log.stem().string() + ".live");
}

// Before the run: the outputs can be written, and none of them replaces an input.
void check_outputs(const LiveArguments& arguments, const std::filesystem::path& report, const Scene& scene) {
    const std::string& device = arguments.device.session.device;
    std::vector<std::filesystem::path> inputs{arguments.scene};
    for (const auto& [key, file] : files_of(scene))
        inputs.emplace_back(file->path);
    if (constexpr std::string_view kReplay = "replay:"; device.starts_with(kReplay))
        inputs.emplace_back(device.substr(kReplay.size()));
    std::vector<std::pair<std::string, std::filesystem::path>> outputs{{"--log " + arguments.log, arguments.log}};
    for (const char* const ending : {".txt", ".json", ".html"})
        if (!report.empty())
            outputs.emplace_back("the report's " + report.filename().string() + ending,
                                 std::filesystem::path(report) += ending);
    std::error_code ignored;
    if (!arguments.log.empty() && std::filesystem::is_directory(arguments.log, ignored))
        throw UsageError("--log {}: is a folder; say the name of a CSV file in it", arguments.log);
    if (const std::string ending = std::filesystem::path(arguments.log).extension().string();
        ending == ".exr" || ending == ".npy" || ending == ".json" || ending == ".html")
        throw UsageError("--log {}: a log is a CSV file, so its name ends in .csv; explore makes an EXR of it",
                         arguments.log);
    refuse_replacing(outputs, inputs);
    // Scenes that the loop reads again are kept next to the log: never in place of the one that is watched.
    const std::filesystem::path scene_file = std::filesystem::absolute(arguments.scene);
    const std::filesystem::path log = std::filesystem::absolute(arguments.log.empty() ? "." : arguments.log);
    if (scene_file.parent_path() == log.parent_path() &&
        scene_file.filename().string().starts_with(log.stem().string() + ".scene-"))
        throw UsageError("--log {}: {} may be one of the scenes that are kept next to it; choose another name",
                         arguments.log, arguments.scene);
    if (!report.empty() && ::access(report.parent_path().c_str(), W_OK) != 0)
        throw file_error("write", report, errno);
}

// A live loop runs in double precision unless the flags or the scene say otherwise.
std::vector<Override> precision_of(const std::string& scene, const CommonOptions& common) {
    if (!common.precision.empty())
        return overrides(common);
    const Study study = read_study(scene);
    const bool chooses = std::ranges::all_of(study.cases, &Case::chooses_precision);
    return chooses ? std::vector<Override>{{"run.precision", "f64"}} : std::vector<Override>{};
}

// `report`: why it could not be written; empty: it was, or none was asked for.
int outcome_code(const device::SessionResult& result, const std::string& report) {
    const std::string also = report.empty() ? "" : "; " + report;
    if (!result.log_failure.empty())
        throw IoError("{}; {} samples are in the log, {} are lost{}", result.log_failure, result.outcome.logged,
                      result.outcome.counts.lost, also);
    if (result.end == device::LoopEnd::device_gone)
        throw device::DeviceAbsent("{} is gone{}{}", result.outcome.device, result.error_text, also);
    if (result.outcome.counts.lost > 0)
        throw Error(ExitCode::failed, fmt::format("{} samples are not in the log: the disk could not keep up{}",
                                                  result.outcome.counts.lost, also));
    if (!report.empty())
        throw IoError(report);
    return static_cast<int>(result.interrupted ? ExitCode::interrupted : ExitCode::ok);
}

// Why there is no report.
std::string written_report(const device::LiveOutcome& outcome, const std::filesystem::path& stem,
                           const std::filesystem::path& log) {
    try {
        if (!stem.empty())
            device::write_live_report(outcome, stem, std::filesystem::is_regular_file(log) ? log : "");
        return {};
    } catch (const Error& error) {
        return error.what();
    }
}

int run(const LiveArguments& arguments, const CommonOptions& common) {
    if (!common.gpu.empty())
        throw UsageError("--gpu: the live loop runs on the CPU");
    if (arguments.device.session.watch && is_standard_input(arguments.scene))
        throw UsageError("--watch: standard input is read once; name a scene's file");
    if (arguments.port && !arguments.view)
        throw UsageError("--port is of the page that --view serves: say --view, too");
    if (!arguments.renderer.empty() && arguments.device.session.watch)
        throw UsageError("--renderer and --watch exclude each other: a renderer has one scene");
    if (const std::string& device = arguments.device.session.device;
        !arguments.renderer.empty() && !arguments.device.session.unstable && device != "sim" &&
        !device.starts_with("sim:") && !device.starts_with("replay:"))
        throw UsageError("--renderer on {}: forces of a library that has not been checked, on a hand; try --device sim "
                         "first, and say --unstable to display them within the limits of --max-force and --slew",
                         device);
    const Case one = load_scene(arguments.scene, common);
    const std::filesystem::path stem = report_stem(arguments);
    check_outputs(arguments, stem, one.scene);
    device::SessionOptions options = checked_options(arguments.device);
    options.scene = arguments.scene;
    options.read = [path = arguments.scene, replaced = precision_of(arguments.scene, common),
                    preparation = std::make_shared<CasePreparation>(),
                    printed = std::make_shared<std::vector<std::string>>(), &common] {
        PreparedCase prepared = preparation->prepare(read_scene(path, replaced));
        preparation->wait(); // nothing else is to use disk and cores once the loop runs,
        keep_meshes_in({});  // nor when a later version of the scene is read
        std::vector<std::string> warnings;
        if (prepared.images.mesh)
            warnings = warnings_of(prepared.one.scene.surface.mesh, *prepared.images.mesh, MeshUse::path);
        if (warnings != *printed) // once for each version of a watched scene
            print_warnings(*printed = warnings, common);
        return prepared;
    };
    options.real_time = !arguments.fast;
    if (arguments.view)
        options.view_port = page_port(arguments.port);
    if (!arguments.log.empty())
        options.log = std::filesystem::absolute(arguments.log);
    options.quiet = common.quiet || common.silent;
    options.replace_log = common.overwrite;
    if (common.no_clobber && !arguments.log.empty() && !may_write({options.log}, common))
        return 0;
    const auto failure = std::make_shared<std::string>();
    if (!arguments.renderer.empty()) {
        const RendererSource source = parse_renderer(arguments.renderer);
        options.law = fmt::format("by the renderer {}: {}, SHA-256 {}", source.name, source.library.string(),
                                  sha256_of_file(source.library));
        options.make_law = [source, failure](const PreparedCase& prepared, double period) {
            return std::make_unique<RendererLaw>(source, prepared, period, failure);
        };
    }
    const device::SessionResult result = device::run_session(options);
    note(common, "{}", device::report_text(result.outcome));
    if (common.json)
        print_data(device::report_json(result.outcome).dump(2) + "\n");
    const int code = outcome_code(result, written_report(result.outcome, stem, options.log));
    if (!failure->empty())
        throw Error(ExitCode::failed,
                    fmt::format("{} {}; there was no force from then on", arguments.renderer, *failure));
    return code;
}

void describe(Options& options, LiveArguments& arguments) {
    device::SessionOptions& session = arguments.device.session;
    options.required("SCENE", arguments.scene, "scene file (TOML); needs no [grid]");
    describe_device(options, arguments.device);
    read_positive(options, "--duration TIME", session.duration, Dimension::time,
                  "ends after it (\"60 s\"); default: until Ctrl-C");
    options.optional("--log FILE", arguments.log,
                     "a CSV file, or a pipe (mkfifo) that is read: a line a sample, with what explore writes, the "
                     "displayed force, times");
    options.read(
        "--send udp:[HOST:]PORT",
        [&session](const std::string& text) { session.send = device::parse_udp_address(text); },
        "samples in UDP datagrams to a tool of your own, on this machine unless HOST, an address in digits, says "
        "another; each sample is 16 doubles, little-endian: t, x, y, z, gx, gy, gz, fx, fy, fz, cx, cy, cz, depth, "
        "facet, tick, as in the log");
    options.flag("--view", arguments.view,
                 "serve a page for browsers on this machine: force over time and over place, while the loop runs");
    options.optional("--port N", arguments.port, "of that page (default: any that is free)");
    options.optional("--report STEM", arguments.report,
                     "STEM.txt, STEM.json and STEM.html at the end (default: next to the log, LOG.live.*)");
    options.flag("--watch", session.watch, "read the scene again whenever its file is saved");
    options.optional("--renderer LIBRARY[:OPTIONS]", arguments.renderer,
                     "forces by a shared library of your own (forceshade_renderer.h), for sim and replay");
    options.flag("--fast", arguments.fast, "sim and replay: as fast as possible, not by the clock");
    describe_safety(options, arguments.device);
    options
        .example("live bump.toml --duration \"2 s\" --fast --log felt.csv", "a simulated hand, faster than the clock")
        .example("live bump.toml --device sim --duration \"1 s\" --max-force \"1 N\"", "by the clock, with a limit")
        .example("live bump.toml --duration \"1 s\" --view --send udp:5005", "seen in a browser, and sent to a tool");
}

} // namespace

void add_live_command(CommandLine& program) {
    program.add<LiveArguments>("live", "Let a haptic device feel a scene, by the oracle on the CPU", run, describe);
}

} // namespace forceshade
