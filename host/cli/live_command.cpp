#include "host/cli/live_command.h"

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <sched.h>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/report/report_json.h"
#include "device/report/report_text.h"
#include "device/report/write_report.h"
#include "device/session/session.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/files.h"
#include "host/prepare/prepared_case.h"
#include "host/program.h"
#include "host/scene/document.h"
#include "host/scene/quantity.h"
#include "host/scene/schema.h"

namespace forceshade {

std::filesystem::path live_report_stem(const std::string& report, const std::string& name) {
    if (!report.empty())
        return std::filesystem::absolute(report);
    if (name.empty())
        return {};
    const std::filesystem::path log = std::filesystem::absolute(name);
    std::error_code ignored;
    if (std::filesystem::exists(log, ignored) && !std::filesystem::is_regular_file(log, ignored))
        return {}; // beside /dev/null there is no place for it
    return log.parent_path() / (log.stem().string() + ".live");
}

void check_live_outputs(const LiveFiles& files, const Scene& scene) {
    std::vector<std::filesystem::path> inputs{files.scene, scene.surface.map.path, scene.surface.mesh.path};
    if (scene.texture)
        inputs.emplace_back(scene.texture->map.path);
    if (scene.paths)
        inputs.emplace_back(scene.paths->path);
    if (constexpr std::string_view kReplay = "replay:"; files.device.starts_with(kReplay))
        inputs.emplace_back(files.device.substr(kReplay.size()));
    std::vector<std::pair<std::string, std::filesystem::path>> outputs{{"--log " + files.log, files.log}};
    for (const char* const ending : {".txt", ".json", ".png"})
        if (!files.report.empty())
            outputs.emplace_back("the report's " + files.report.filename().string() + ending,
                                 std::filesystem::path(files.report) += ending);
    std::error_code ignored;
    if (!files.log.empty() && std::filesystem::is_directory(files.log, ignored))
        throw UsageError(fmt::format("--log {}: is a folder; say the name of a CSV file in it", files.log));
    if (const std::string ending = std::filesystem::path(files.log).extension().string();
        ending == ".exr" || ending == ".npy" || ending == ".json" || ending == ".png")
        throw UsageError(fmt::format(
            "--log {}: a log is a CSV file, so its name ends in .csv; explore makes an EXR of it", files.log));
    for (const auto& [name, output] : outputs)
        for (const std::filesystem::path& input : inputs)
            if (std::filesystem::equivalent(output, input, ignored))
                throw UsageError(
                    fmt::format("{} would replace {}, which is read; choose another name", name, input.string()));
    // Scenes that are taken up are kept beside the log: never in place of the one that is watched.
    const std::filesystem::path scene_file = std::filesystem::absolute(files.scene);
    const std::filesystem::path log = std::filesystem::absolute(files.log.empty() ? "." : files.log);
    if (scene_file.parent_path() == log.parent_path() &&
        scene_file.filename().string().starts_with(log.stem().string() + ".scene-"))
        throw UsageError(fmt::format("--log {}: {} may be one of the scenes that are kept beside it; choose another "
                                     "name",
                                     files.log, files.scene));
    if (!files.report.empty() && ::access(files.report.parent_path().c_str(), W_OK) != 0)
        throw file_error("write", files.report, errno);
}

namespace {

constexpr std::string_view kNone = "none"; // for a limit that is to be switched off

struct LiveArguments {
    std::string scene, device = "sim", log, report;
    std::string rate, duration, patience;
    std::string max_force, lasting_force, slew, ramp, contact_ramp, max_speed, stale, damping;
    std::string workspace, origin, watchdog;
    std::optional<int> cpu;
    bool fast = false, watch = false, overwrite = false, passivity = false, without_watchdog = false;
};

double parsed(const std::string& flag, const std::string& text, Dimension dimension) {
    try {
        return parse_quantity(text, dimension);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: {}", flag, error.what()));
    }
}

// In SI units; `text` is empty where the user says nothing.
std::optional<double> quantity(const std::string& flag, const std::string& text, Dimension dimension, bool may_be_none,
                               bool may_be_zero = false) {
    if (text.empty())
        return std::nullopt;
    if (may_be_none && text == kNone)
        return device::kUnknown;
    const double value = parsed(flag, text, dimension);
    if (!(value > 0) && !(may_be_zero && value == 0))
        throw UsageError(fmt::format("{} must be {}, got {}", flag, may_be_zero ? "zero or more" : "positive", text));
    return value;
}

// None is no ramp at all.
std::optional<double> ramp(const std::string& flag, const std::string& text) {
    return quantity(flag, text == kNone ? "0 s" : text, Dimension::time, false, true);
}

std::optional<double> periods(const std::string& text) {
    if (text.empty())
        return std::nullopt;
    if (text == kNone)
        return device::kUnknown;
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || end != text.data() + text.size() || !(value >= 1) || !std::isfinite(value))
        throw UsageError(
            fmt::format("--watchdog: a sample may be late by 1 period or more, as in --watchdog 20, or by any "
                        "time with none; got \"{}\"",
                        text));
    return value;
}

std::optional<int> allowed_cpu(std::optional<int> cpu) {
    cpu_set_t allowed;
    CPU_ZERO(&allowed);
    if (!cpu || ::sched_getaffinity(0, sizeof allowed, &allowed) != 0)
        return cpu;
    if (*cpu >= 0 && *cpu < CPU_SETSIZE && CPU_ISSET(static_cast<std::size_t>(*cpu), &allowed))
        return cpu;
    std::vector<int> there;
    for (int i = 0; i < CPU_SETSIZE; ++i)
        if (CPU_ISSET(static_cast<std::size_t>(i), &allowed))
            there.push_back(i);
    throw UsageError(fmt::format("--cpu {}: this process may run on {}", *cpu, fmt::join(there, ", ")));
}

void take_limits(const LiveArguments& arguments, device::SessionOptions& options) {
    device::SafetyLimits& limits = options.limits;
    options.max_force = quantity("--max-force", arguments.max_force, Dimension::force, true);
    options.lasting_force = quantity("--lasting-force", arguments.lasting_force, Dimension::force, true);
    options.without_watchdog = arguments.without_watchdog;
    limits.slew = quantity("--slew", arguments.slew, Dimension::force_rate, true).value_or(limits.slew);
    limits.ramp = ramp("--ramp", arguments.ramp).value_or(limits.ramp);
    limits.contact_ramp = ramp("--contact-ramp", arguments.contact_ramp).value_or(limits.contact_ramp);
    limits.max_speed = quantity("--max-speed", arguments.max_speed, Dimension::speed, true).value_or(limits.max_speed);
    limits.stale = quantity("--stale", arguments.stale, Dimension::time, true).value_or(limits.stale);
    limits.late = periods(arguments.watchdog).value_or(limits.late);
    limits.passivity = arguments.passivity;
    limits.damping = quantity("--damping", arguments.damping, Dimension::damping, false).value_or(limits.damping);
    if (!arguments.damping.empty() && !arguments.passivity)
        throw UsageError("--damping is the passivity controller's: say --passivity, too");
}

// "0 m, -0.15 m, 0.2 m" as lengths in m; `count` of them.
std::vector<double> lengths(const std::string& flag, const std::string& text, std::size_t count,
                            const std::string& example) {
    std::vector<double> values;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t end = std::min(text.find(',', begin), text.size());
        std::string part = text.substr(begin, end - begin);
        part.erase(0, part.find_first_not_of(' '));
        part.erase(part.find_last_not_of(' ') + 1);
        values.push_back(parsed(flag, part, Dimension::length)); // of either sign
        begin = end + 1;
    }
    if (values.size() != count)
        throw UsageError(fmt::format("{}: {} lengths are wanted, got {}, as in {} \"{}\"", flag, count, values.size(),
                                     flag, example));
    return values;
}

void take_workspace(const LiveArguments& arguments, device::SessionOptions& options) {
    if (arguments.workspace.empty())
        return;
    if (arguments.workspace == kNone) {
        options.workspace.emplace(glm::dvec3(-device::kUnknown), glm::dvec3(device::kUnknown));
        return;
    }
    const std::vector<double> ends =
        lengths("--workspace", arguments.workspace, 6, "-0.1 m, -0.1 m, -0.1 m, 0.1 m, 0.1 m, 0.1 m");
    for (std::size_t i = 0; i < 3; ++i)
        if (!(ends[i] < ends[i + 3]))
            throw UsageError(fmt::format("--workspace: {} m is not below {} m; first the lowest x, y and z, then the "
                                         "highest",
                                         ends[i], ends[i + 3]));
    options.workspace.emplace(glm::dvec3(ends[0], ends[1], ends[2]), glm::dvec3(ends[3], ends[4], ends[5]));
}

void take_origin(const LiveArguments& arguments, device::SessionOptions& options) {
    options.placement.here = arguments.origin == "here";
    if (arguments.origin.empty() || options.placement.here)
        return;
    const std::vector<double> origin = lengths("--origin", arguments.origin, 3, "0 m, -0.15 m, 0.2 m");
    options.placement.origin = {origin[0], origin[1], origin[2]};
}

// A live loop goes in double precision unless somebody says otherwise.
std::vector<Override> precision_of(const std::string& scene, const CommonOptions& common) {
    if (!common.precision.empty())
        return overrides(common);
    const Study study = read_study(scene);
    const auto key = static_cast<std::size_t>(find_key("run.precision"));
    if (study.document->base.find(key) != nullptr)
        return {};
    return {{"run.precision", "f64"}};
}

// `report`: why it could not be written; empty: it was, or none was asked for.
int outcome_code(const device::SessionResult& result, const std::string& report) {
    const std::string also = report.empty() ? "" : "; " + report;
    if (!result.log_failure.empty())
        throw IoError(fmt::format("{}; {} samples are in the log, {} are lost{}", result.log_failure,
                                  result.outcome.logged, result.outcome.counts.lost, also));
    if (result.end == device::LoopEnd::device_gone)
        throw device::DeviceAbsent(fmt::format("{} is gone{}{}", result.outcome.device,
                                               result.complaint.empty() ? "" : ": " + result.complaint, also));
    if (result.outcome.counts.lost > 0)
        throw Error(ExitCode::failed, fmt::format("{} samples are not in the log: the disk could not keep up{}",
                                                  result.outcome.counts.lost, also));
    if (!report.empty())
        throw IoError(report);
    return static_cast<int>(result.interrupted ? ExitCode::interrupted : ExitCode::ok);
}

// Why there is none.
std::string written_report(const device::LiveOutcome& outcome, const std::filesystem::path& stem) {
    try {
        if (!stem.empty())
            device::write_live_report(outcome, stem);
        return {};
    } catch (const IoError& error) {
        return error.what();
    }
}

int run(const LiveArguments& arguments, const CommonOptions& common) {
    if (!common.gpu.empty())
        throw UsageError("--gpu: the live loop runs on the CPU");
    std::vector<std::string> warnings;
    // Refuses what is no single scene.
    const Case one = read_scene(arguments.scene, overrides(common), &warnings);
    const std::filesystem::path stem = live_report_stem(arguments.report, arguments.log);
    check_live_outputs({arguments.scene, arguments.device, arguments.log, stem}, one.scene);
    const std::vector<Override> replaced = precision_of(arguments.scene, common);
    device::SessionOptions options;
    options.scene = arguments.scene;
    options.read = [&, preparation = std::make_shared<CasePreparation>()] {
        return preparation->prepare(read_scene(arguments.scene, replaced));
    };
    options.device = arguments.device;
    options.rate = quantity("--rate", arguments.rate, Dimension::frequency, false);
    options.duration = quantity("--duration", arguments.duration, Dimension::time, false);
    options.patience = quantity("--patience", arguments.patience, Dimension::time, true).value_or(options.patience);
    options.real_time = !arguments.fast;
    options.cpu = allowed_cpu(arguments.cpu);
    if (!arguments.log.empty())
        options.log = std::filesystem::absolute(arguments.log);
    options.replace_log = arguments.overwrite;
    options.watch = arguments.watch;
    options.quiet = common.quiet;
    take_limits(arguments, options);
    take_workspace(arguments, options);
    take_origin(arguments, options);
    print_warnings(warnings, common);
    const device::SessionResult result = device::run_session(options);
    if (!common.quiet)
        remark("{}", device::report_text(result.outcome));
    if (common.json)
        print_data(device::report_json(result.outcome).dump(2) + "\n");
    return outcome_code(result, written_report(result.outcome, stem));
}

void describe(Options& options, LiveArguments& arguments) {
    options.required("SCENE", arguments.scene, "scene file (TOML); needs no [grid]");
    options.optional("--device", arguments.device,
                     "sim (default: the hand and device of [hand], along [paths] or strokes that press 1 N), "
                     "replay:FILE.csv, haply[:URL], dhd[:INDEX] or hd[:NAME]; forceshade devices tells what is there");
    options.optional("--origin", arguments.origin,
                     "where the scene's origin lies in the device's space: \"X, Y, Z\" with units, or here: where the "
                     "probe is at the start (default: at the device's)");
    options.optional("--rate", arguments.rate,
                     "100 Hz to 10 kHz; default: the scene's paths.rate, a recording's own, else \"1 kHz\"");
    options.optional("--duration", arguments.duration, "ends after it (\"60 s\"); default: until Ctrl-C");
    options.optional("--log", arguments.log,
                     "a CSV file, a line a sample: what explore writes, the displayed force, times");
    options.flag("--overwrite", arguments.overwrite, "--log may replace a file");
    options.optional("--report", arguments.report,
                     "STEM.txt, STEM.json and STEM.png at the end (default: beside the log, LOG.live.*)");
    options.flag("--watch", arguments.watch, "take the scene up anew whenever its file is saved");
    options.flag("--fast", arguments.fast, "sim and replay: as fast as possible, not by the clock");
    options.optional("--cpu", arguments.cpu, "CPU to run on (default: the last one, with SCHED_FIFO)");
    options.optional("--patience", arguments.patience,
                     "ends when the device is gone for so long (default \"5 s\"; \"none\": never)");
    options.heading("Safety (\"none\" switches a limit off)");
    options.optional("--max-force", arguments.max_force,
                     "largest force; larger ones keep their direction (default: the device's, or \"3 N\")");
    options.optional("--lasting-force", arguments.lasting_force,
                     "largest root mean square of the force over 10 s, for the motors' sake (default: the device's)");
    options.flag("--without-device-watchdog", arguments.without_watchdog,
                 "more than 0.5 N even where the device refuses its own watchdog: what a killed process displayed "
                 "last then stays on");
    options.optional("--slew", arguments.slew, "how fast the force may come up (default \"2 N/ms\"); it falls at once");
    options.optional("--ramp", arguments.ramp,
                     "in which the force comes up after the start and after a fault (default \"200 ms\")");
    options.optional("--contact-ramp", arguments.contact_ramp,
                     "likewise when contact is made after 50 ms without (default \"5 ms\")");
    options.optional("--max-speed", arguments.max_speed, "no force while the probe is faster (default \"2 m/s\")");
    options.optional("--stale", arguments.stale, "no force when positions are older (default \"20 ms\")");
    options.optional("--watchdog", arguments.watchdog,
                     "periods: no force when a sample is later than so many (default 20)");
    options.optional("--workspace", arguments.workspace,
                     "no force outside of lowest x, y, z and highest x, y, z, six lengths between commas (default: "
                     "the device's)");
    options.flag("--passivity", arguments.passivity,
                 "take back by damping what energy the hand is given (Hannaford & Ryu 2002)");
    options.optional("--damping", arguments.damping, "the most that --passivity may damp (default \"10 N s/m\")");
}

} // namespace

void add_live_command(CommandLine& program) {
    program.add<LiveArguments>("live", "Let a haptic device feel a scene, by the oracle on the CPU", run, describe);
}

} // namespace forceshade
