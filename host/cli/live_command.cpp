#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <filesystem>
#include <optional>
#include <string_view>
#include <unistd.h>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "device/loop/permissions.h"
#include "device/report/report.h"
#include "device/session/session.h"
#include "host/cli/command.h"
#include "host/error.h"
#include "host/output/files.h"
#include "host/prepare/prepared_case.h"
#include "host/scene/document.h"
#include "host/scene/quantity.h"
#include "host/scene/schema.h"

namespace forceshade {

namespace {

constexpr std::string_view kNone = "none"; // for a limit that is to be switched off

struct LiveArguments {
    std::string scene, log, report;
    bool fast = false;
    std::optional<double> damping;  /* N s/m */
    device::SessionOptions session; // what the options say directly
};

// STEM of the report: as on the command line, or beside the log, unless that is no regular file; empty: none.
std::filesystem::path report_stem(const LiveArguments& arguments) {
    if (!arguments.report.empty())
        return std::filesystem::absolute(arguments.report);
    if (arguments.log.empty())
        return {};
    const std::filesystem::path log = std::filesystem::absolute(arguments.log);
    std::error_code ignored;
    if (std::filesystem::exists(log, ignored) && !std::filesystem::is_regular_file(log, ignored))
        return {}; // beside /dev/null there is no place for it
    return log.parent_path() / (log.stem().string() + ".live");
}

// Before the run: what is written at the end has a place, and nothing that is read is written over.
void check_outputs(const LiveArguments& arguments, const std::filesystem::path& report, const Scene& scene) {
    const std::string& device = arguments.session.device;
    std::vector<std::filesystem::path> inputs{arguments.scene, scene.surface.map.path, scene.surface.mesh.path};
    if (scene.texture)
        inputs.emplace_back(scene.texture->map.path);
    if (scene.paths)
        inputs.emplace_back(scene.paths->path);
    if (constexpr std::string_view kReplay = "replay:"; device.starts_with(kReplay))
        inputs.emplace_back(device.substr(kReplay.size()));
    std::vector<std::pair<std::string, std::filesystem::path>> outputs{{"--log " + arguments.log, arguments.log}};
    for (const char* const ending : {".txt", ".json", ".png"})
        if (!report.empty())
            outputs.emplace_back("the report's " + report.filename().string() + ending,
                                 std::filesystem::path(report) += ending);
    std::error_code ignored;
    if (!arguments.log.empty() && std::filesystem::is_directory(arguments.log, ignored))
        throw UsageError(fmt::format("--log {}: is a folder; say the name of a CSV file in it", arguments.log));
    if (const std::string ending = std::filesystem::path(arguments.log).extension().string();
        ending == ".exr" || ending == ".npy" || ending == ".json" || ending == ".png")
        throw UsageError(fmt::format(
            "--log {}: a log is a CSV file, so its name ends in .csv; explore makes an EXR of it", arguments.log));
    for (const auto& [name, output] : outputs)
        for (const std::filesystem::path& input : inputs)
            if (std::filesystem::equivalent(output, input, ignored))
                throw UsageError(
                    fmt::format("{} would replace {}, which is read; choose another name", name, input.string()));
    // Scenes that the loop reads again are kept beside the log: never in place of the one that is watched.
    const std::filesystem::path scene_file = std::filesystem::absolute(arguments.scene);
    const std::filesystem::path log = std::filesystem::absolute(arguments.log.empty() ? "." : arguments.log);
    if (scene_file.parent_path() == log.parent_path() &&
        scene_file.filename().string().starts_with(log.stem().string() + ".scene-"))
        throw UsageError(fmt::format("--log {}: {} may be one of the scenes that are kept beside it; choose another "
                                     "name",
                                     arguments.log, arguments.scene));
    if (!report.empty() && ::access(report.parent_path().c_str(), W_OK) != 0)
        throw file_error("write", report, errno);
}

double parsed(const std::string& flag, const std::string& text, Dimension dimension) {
    try {
        return parse_quantity(text, dimension);
    } catch (const UsageError& error) {
        throw UsageError(fmt::format("{}: {}", flag, error.what()));
    }
}

enum class Accepted { positive, positive_or_none, ramp }; // none is no limit, or no ramp at all

// In SI units.
double quantity(const std::string& flag, const std::string& text, Dimension dimension, Accepted accepted) {
    const bool is_ramp = accepted == Accepted::ramp;
    if (accepted != Accepted::positive && text == kNone)
        return is_ramp ? 0 : device::kUnknown;
    const double value = parsed(flag, text, dimension);
    if (!(value > 0) && !(is_ramp && value == 0))
        throw UsageError(fmt::format("{} must be {}, got {}", flag, is_ramp ? "zero or more" : "positive", text));
    return value;
}

double periods(const std::string& text) {
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

void check_cpu(std::optional<int> cpu) {
    const std::vector<int> allowed = device::allowed_cpus();
    if (cpu && !allowed.empty() && std::find(allowed.begin(), allowed.end(), *cpu) == allowed.end())
        throw UsageError(fmt::format("--cpu {}: this process may run on {}", *cpu, fmt::join(allowed, ", ")));
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

std::pair<glm::dvec3, glm::dvec3> workspace(const std::string& text) {
    if (text == kNone)
        return {glm::dvec3(-device::kUnknown), glm::dvec3(device::kUnknown)};
    const std::vector<double> ends = lengths("--workspace", text, 6, "-0.1 m, -0.1 m, -0.1 m, 0.1 m, 0.1 m, 0.1 m");
    for (std::size_t i = 0; i < 3; ++i)
        if (!(ends[i] < ends[i + 3]))
            throw UsageError(fmt::format("--workspace: {} m is not below {} m; first the lowest x, y and z, then the "
                                         "highest",
                                         ends[i], ends[i + 3]));
    return {{ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}};
}

void read_origin(const std::string& text, device::SessionOptions& session) {
    session.origin_here = text == "here";
    if (session.origin_here)
        return;
    const std::vector<double> origin = lengths("--origin", text, 3, "0 m, -0.15 m, 0.2 m");
    session.origin = {origin[0], origin[1], origin[2]};
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
        throw device::DeviceAbsent(fmt::format("{} is gone{}{}", result.outcome.device, result.complaint, also));
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
    if (arguments.damping && !arguments.session.limits.passivity)
        throw UsageError("--damping is the passivity controller's: say --passivity, too");
    const Case one = load_scene(arguments.scene, common);
    const std::filesystem::path stem = report_stem(arguments);
    check_outputs(arguments, stem, one.scene);
    check_cpu(arguments.session.cpu);
    device::SessionOptions options = arguments.session;
    options.scene = arguments.scene;
    options.read = [path = arguments.scene, replaced = precision_of(arguments.scene, common),
                    preparation = std::make_shared<CasePreparation>()] {
        return preparation->prepare(read_scene(path, replaced));
    };
    options.real_time = !arguments.fast;
    if (!arguments.log.empty())
        options.log = std::filesystem::absolute(arguments.log);
    options.quiet = common.quiet;
    options.limits.damping = arguments.damping.value_or(options.limits.damping);
    const device::SessionResult result = device::run_session(options);
    if (!common.quiet)
        remark("{}", device::report_text(result.outcome));
    if (common.json)
        print_data(device::report_json(result.outcome).dump(2) + "\n");
    return outcome_code(result, written_report(result.outcome, stem));
}

void describe(Options& options, LiveArguments& arguments) {
    device::SessionOptions& session = arguments.session;
    device::SafetyLimits& limits = session.limits;
    const auto add = [&options](const char* flag, auto& value, Dimension dimension, Accepted accepted,
                                const char* help) {
        const auto read = [=, &value](const std::string& text) { value = quantity(flag, text, dimension, accepted); };
        options.read(flag, read, help);
    };
    options.required("SCENE", arguments.scene, "scene file (TOML); needs no [grid]");
    options.optional("--device", session.device,
                     "sim (default: the hand and device of [hand], along [paths] or strokes that press 1 N), "
                     "replay:FILE.csv, haply[:URL], dhd[:INDEX] or hd[:NAME]; forceshade devices tells what is there");
    options.read(
        "--origin", [&session](const std::string& text) { read_origin(text, session); },
        "where the scene's origin lies in the device's space: \"X, Y, Z\" with units, or here: where the "
        "probe is at the start (default: at the device's)");
    add("--rate", session.rate, Dimension::frequency, Accepted::positive,
        "100 Hz to 10 kHz; default: the scene's paths.rate, a recording's own, else \"1 kHz\"");
    add("--duration", session.duration, Dimension::time, Accepted::positive,
        "ends after it (\"60 s\"); default: until Ctrl-C");
    options.optional("--log", arguments.log,
                     "a CSV file, a line a sample: what explore writes, the displayed force, times");
    options.flag("--overwrite", session.replace_log, "--log may replace a file");
    options.optional("--report", arguments.report,
                     "STEM.txt, STEM.json and STEM.png at the end (default: beside the log, LOG.live.*)");
    options.flag("--watch", session.watch, "read the scene again whenever its file is saved");
    options.flag("--fast", arguments.fast, "sim and replay: as fast as possible, not by the clock");
    options.optional("--cpu", session.cpu, "CPU to run on (default: the last one, with SCHED_FIFO)");
    add("--patience", session.patience, Dimension::time, Accepted::positive_or_none,
        "ends when the device is gone for so long (default \"5 s\"; \"none\": never)");
    options.heading("Safety (\"none\" switches a limit off)");
    add("--max-force", session.max_force, Dimension::force, Accepted::positive_or_none,
        "largest force; larger ones keep their direction (default: the device's, or \"3 N\")");
    add("--lasting-force", session.lasting_force, Dimension::force, Accepted::positive_or_none,
        "largest root mean square of the force over 10 s, for the motors' sake (default: the device's)");
    options.flag("--without-device-watchdog", session.without_watchdog,
                 "more than 0.5 N even where the device refuses its own watchdog: what a killed process displayed "
                 "last then stays on");
    add("--slew", limits.slew, Dimension::force_rate, Accepted::positive_or_none,
        "how fast the force may come up (default \"2 N/ms\"); it falls at once");
    add("--ramp", limits.ramp, Dimension::time, Accepted::ramp,
        "in which the force comes up after the start and after a fault (default \"200 ms\")");
    add("--contact-ramp", limits.contact_ramp, Dimension::time, Accepted::ramp,
        "likewise when contact is made after 50 ms without (default \"5 ms\")");
    add("--max-speed", limits.max_speed, Dimension::speed, Accepted::positive_or_none,
        "no force while the probe is faster (default \"2 m/s\")");
    add("--stale", limits.stale, Dimension::time, Accepted::positive_or_none,
        "no force when positions are older (default \"20 ms\")");
    options.read(
        "--watchdog", [&limits](const std::string& text) { limits.late = periods(text); },
        "periods: no force when a sample is later than so many (default 20)");
    options.read(
        "--workspace", [&session](const std::string& text) { session.workspace = workspace(text); },
        "no force outside of lowest x, y, z and highest x, y, z, six lengths between commas (default: "
        "the device's)");
    options.flag("--passivity", limits.passivity,
                 "take back by damping what energy the hand is given (Hannaford & Ryu 2002)");
    add("--damping", arguments.damping, Dimension::damping, Accepted::positive,
        "the most that --passivity may damp (default \"10 N s/m\")");
}

} // namespace

void add_live_command(CommandLine& program) {
    program.add<LiveArguments>("live", "Let a haptic device feel a scene, by the oracle on the CPU", run, describe);
}

} // namespace forceshade
