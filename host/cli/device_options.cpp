#include "host/cli/command.h"

#include <algorithm>
#include <cmath>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "device/loop/real_time.h"
#include "host/error.h"

namespace forceshade {

namespace {

constexpr std::string_view kNone = "none"; // for a limit that is to be switched off

enum class Accepted { positive, positive_or_none, ramp }; // none is no limit, or no ramp at all

// In SI units.
double quantity(const std::string& flag, const std::string& text, Dimension dimension, Accepted accepted) {
    const bool is_ramp = accepted == Accepted::ramp;
    if (accepted != Accepted::positive && text == kNone)
        return is_ramp ? 0 : device::kUnknown;
    const double value = option_quantity(flag, text, dimension);
    if (!(value > 0) && !(is_ramp && value == 0))
        throw UsageError("{} must be {}, got {}", flag, is_ramp ? "zero or more" : "positive", text);
    return value;
}

void check_cpu(std::optional<int> cpu) {
    const std::vector<int> allowed = device::allowed_cpus();
    if (cpu && !allowed.empty() && std::find(allowed.begin(), allowed.end(), *cpu) == allowed.end())
        throw UsageError("--cpu {}: this process may run on {}", *cpu, fmt::join(allowed, ", "));
}

// "0 m, -0.15 m, 0.2 m" as lengths in m; `count` of them.
std::vector<double> lengths(const std::string& flag, const std::string& text, std::size_t count,
                            const std::string& example) {
    std::vector<double> values;
    for (const std::string& part : split(text, ','))
        values.push_back(option_quantity(flag, part, Dimension::length)); // of either sign
    if (values.size() != count)
        throw UsageError("{} needs {} lengths, got {}; for example {} \"{}\"", flag, count, values.size(), flag,
                         example);
    return values;
}

std::pair<glm::dvec3, glm::dvec3> workspace(const std::string& text) {
    if (text == kNone)
        return {glm::dvec3(-device::kUnknown), glm::dvec3(device::kUnknown)};
    const std::vector<double> ends = lengths("--workspace", text, 6, "-0.1 m, -0.1 m, -0.1 m, 0.1 m, 0.1 m, 0.1 m");
    for (std::size_t i = 0; i < 3; ++i)
        if (!(ends[i] < ends[i + 3]))
            throw UsageError("--workspace: {} m is not below {} m; first the lowest x, y and z, then the highest",
                             ends[i], ends[i + 3]);
    return {{ends[0], ends[1], ends[2]}, {ends[3], ends[4], ends[5]}};
}

void read_origin(const std::string& text, device::SessionOptions& session) {
    session.origin_here = text == "here";
    if (session.origin_here)
        return;
    const std::vector<double> origin = lengths("--origin", text, 3, "0 m, -0.15 m, 0.2 m");
    session.mapping.origin = {origin[0], origin[1], origin[2]};
}

// "z 90 deg, x 30 deg": turns about the device's axes, one after the other.
glm::dmat3 rotation(const std::string& text) {
    glm::dmat3 turn(1);
    for (const std::string& part : split(text, ',')) {
        const std::size_t begin = std::min(part.find_first_not_of(' '), part.size());
        const std::size_t axis = part.size() > begin + 1 && part[begin + 1] == ' '
                                     ? std::string_view("xyz").find(part[begin])
                                     : std::string_view::npos;
        if (axis == std::string_view::npos)
            throw UsageError("--rotate \"{}\": expected an axis of the device and an angle, as in --rotate "
                             "\"z 90 deg\", or several between commas",
                             text);
        turn = device::turn_about(static_cast<int>(axis),
                                  option_quantity("--rotate", part.substr(begin + 2), Dimension::angle)) *
               turn;
    }
    return turn;
}

double scale(const std::string& text) {
    if (const auto value = number_in(text, 1e-3, 1e3))
        return *value;
    throw UsageError("--scale: metres of the scene in a metre of the device, from 0.001 to 1000, got \"{}\"", text);
}

// Adds an option that reads a quantity.
template <typename T>
void add(Options& options, const char* flag, T& value, Dimension dimension, Accepted accepted, const char* help) {
    const std::string name = std::string(flag).substr(0, std::string_view(flag).find(' '));
    options.read(
        flag, [=, &value](const std::string& text) { value = quantity(name, text, dimension, accepted); }, help);
}

} // namespace

void describe_device(Options& options, DeviceArguments& arguments) {
    device::SessionOptions& session = arguments.session;
    options.optional("--device DEVICE", session.device,
                     "sim (default: the hand and device of [hand], along [paths] or strokes that press 1 N), "
                     "replay:FILE.csv, haply[:URL], dhd[:INDEX] or hd[:NAME]; forceshade devices lists them. sim:1@0.5 "
                     "s..3 s,2@1 s..2 s: its hand holds these buttons then");
    options.read(
        "--origin X,Y,Z", [&session](const std::string& text) { read_origin(text, session); },
        "where the scene's origin lies in the device's space: \"X, Y, Z\" with units, or here: where the probe is at "
        "the start (default: at the device's)");
    options.read(
        "--rotate AXIS ANGLE", [&session](const std::string& text) { session.mapping.turn = rotation(text); },
        "how the scene lies turned in the device's space: \"z 90 deg\" about the device's z, right-handed; several, "
        "one after the other, between commas");
    options.read(
        "--scale RATIO", [&session](const std::string& text) { session.mapping.scale = scale(text); },
        "metres of the scene in a metre of the device (default 1): with 2 it is displayed half as large, and springs "
        "twice as stiff");
    options.read(
        "--clutch BUTTON", [&session](const std::string& text) { session.clutch = read_button("--clutch", text); },
        "button of the device: while it is held the probe stays, without force, and the hand moves alone");
    options.read(
        "--dead-man BUTTON",
        [&session](const std::string& text) { session.dead_man = read_button("--dead-man", text); },
        "button of the device: there is no force unless it is held");
    add(options, "--rate FREQUENCY", session.asked_rate, Dimension::frequency, Accepted::positive,
        "100 Hz to 10 kHz; default: the scene's paths.rate, a recording's own, else \"1 kHz\"");
    options.optional("--cpu CPU", session.cpu, "CPU to run on (default: the last one, with SCHED_FIFO)");
    add(options, "--patience TIME", session.patience, Dimension::time, Accepted::positive_or_none,
        "ends when the device is gone for this long (default \"5 s\"; \"none\": never)");
}

void describe_safety(Options& options, DeviceArguments& arguments) {
    device::SessionOptions& session = arguments.session;
    device::SafetyLimits& limits = session.limits;
    options.heading("Safety (\"none\" switches a limit off)");
    add(options, "--max-force FORCE", session.max_force, Dimension::force, Accepted::positive_or_none,
        "largest force; larger ones keep their direction (default: the device's, or \"3 N\")");
    add(options, "--lasting-force FORCE", session.continuous_force, Dimension::force, Accepted::positive_or_none,
        "largest root mean square of the force over 10 s, for the motors' sake (default: the device's)");
    options.flag("--without-device-watchdog", session.without_watchdog,
                 "more than 0.5 N even where the device refuses its own watchdog: what a killed process displayed last "
                 "then stays on");
    add(options, "--slew RATE", limits.slew, Dimension::force_rate, Accepted::positive_or_none,
        "how fast the force may rise (default \"2 N/ms\"); it falls at once");
    add(options, "--ramp TIME", limits.ramp, Dimension::time, Accepted::ramp,
        "in which the force rises after the start and after a fault (default \"200 ms\")");
    add(options, "--contact-ramp TIME", limits.contact_ramp, Dimension::time, Accepted::ramp,
        "in which the force rises when contact is made after 50 ms without (default \"5 ms\")");
    add(options, "--max-speed SPEED", limits.max_speed, Dimension::speed, Accepted::positive_or_none,
        "no force while the probe is faster (default \"2 m/s\")");
    add(options, "--stale TIME", limits.stale, Dimension::time, Accepted::positive_or_none,
        "no force when positions are older (default \"20 ms\")");
    add(options, "--watchdog TIME", limits.late, Dimension::time, Accepted::positive_or_none,
        "no force when a sample is later than this (default \"20 ms\")");
    options.read(
        "--workspace LENGTHS", [&session](const std::string& text) { session.workspace = workspace(text); },
        "no force outside of lowest x, y, z and highest x, y, z, six lengths between commas, in the device's axes from "
        "the scene's origin (default: the device's)");
    options.flag("--unstable", session.unstable,
                 "feel a scene on hardware even if its stiffness is above what the hand of [hand] comes to rest at");
    options.flag("--without-fade", arguments.without_fade,
                 "keep a force that drives an oscillation in a scene beyond its stability; else it fades out in 20 ms "
                 "until the probe has left the surface");
    options.flag("--passivity", arguments.passivity,
                 "take back by damping what energy the hand is given (Hannaford & Ryu 2002), as hand.passivity does");
    add(options, "--damping DAMPING", arguments.damping, Dimension::damping, Accepted::positive,
        "the most that --passivity may damp (default \"10 N s/m\")");
}

unsigned read_button(const char* flag, const std::string& text) {
    if (const auto number = number_in(text, 1u, 32u))
        return *number;
    throw UsageError("{}: a button's number from 1 to 32, got \"{}\"", flag, text);
}

std::uint16_t page_port(const std::optional<int>& port) {
    constexpr int kMostPort = 65535;
    if (port && (*port < 0 || *port > kMostPort))
        throw UsageError("--port: 1 to {}, got {}", kMostPort, *port);
    return static_cast<std::uint16_t>(port.value_or(0));
}

void read_positive(Options& options, const char* flag, std::optional<double>& value, Dimension dimension,
                   const char* help) {
    add(options, flag, value, dimension, Accepted::positive, help);
}

device::SessionOptions checked_options(const DeviceArguments& arguments) {
    if (arguments.damping && !arguments.passivity)
        throw UsageError("--damping is the passivity controller's: say --passivity, too");
    check_cpu(arguments.session.cpu);
    device::SessionOptions options = arguments.session;
    options.limits.fade = !arguments.without_fade;
    if (arguments.passivity)
        options.limits.passivity = arguments.damping.value_or(device::kPassiveDamping);
    return options;
}

} // namespace forceshade
