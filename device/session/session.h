// A run of the live loop from the scene's file to the report: the loop, its log, a person at the terminal.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/loop/live_loop.h"
#include "device/run_report/report.h"
#include "device/session/udp_sender.h"
#include "host/field/prepared_case.h"
#include "host/limits/limits.h"

namespace forceshade::device {

struct SessionOptions {
    std::filesystem::path scene;        // its file
    std::function<PreparedCase()> read; // makes a case of it, in the precision of the run
    std::string device = "sim";         // for open_device()
    Mapping mapping;
    bool origin_here = false;               // its origin is where the probe is at the start instead
    unsigned dead_man = 0, clutch = 0;      // buttons, as in LoopSettings
    std::optional<double> rate;             /* Hz */
    std::optional<double> duration;         /* s; none: until the recording ends or an interrupt */
    bool real_time = true;                  // false: as fast as possible (sim and replay)
    std::optional<int> cpu;                 // that the loop runs on
    double patience = 5;                    /* s: as in LoopSettings */
    bool without_watchdog = false;          // a device's own, which may then display more than kUnwatchedForce
    std::optional<double> max_force;        /* N: none: the device's, or kCautiousForce */
    std::optional<double> continuous_force; /* N: none: the device's */
    SafetyLimits limits;                    // the others
    std::optional<std::pair<glm::dvec3, glm::dvec3>> workspace; /* m: as in SafetyLimits; none: the device's */
    std::filesystem::path log;                                  // empty: none
    bool replace_log = false;
    std::optional<UdpAddress> send;         // also receives the samples
    std::optional<std::uint16_t> view_port; // of a page that shows them, 0 for any that is free; none: no page
    bool watch = false;                     // whether the loop reads the scene again when its file changes
    bool unstable = false;                  // feel a scene on hardware, too, whose stiffness is above its limit
    bool quiet = false;
};

/// How it ended, for the caller to make an exit code of.
struct SessionResult {
    LiveOutcome outcome;
    LoopEnd end = LoopEnd::stopped;
    bool interrupted = false;
    std::string error_text;  // of the missing device, after ": "; empty: none
    std::string log_failure; // why the log is not whole
};

/// An open device with the settings of its loop: for callers that have a loop of their own.
struct OpenDevice {
    std::unique_ptr<BackEnd> device;
    DeviceFacts facts; /* its workspace counted from the scene's origin, in the device's axes */
    LoopSettings settings;
    std::vector<std::string> warnings;
};

/// Opens the device that the options name, for a scene; rate, mapping and limits from the options. \throws UsageError,
/// IoError, DeviceAbsent.
OpenDevice open_for_loop(const SessionOptions& options, const PreparedCase& prepared);

/// Whether the scene is stable on the device: pressed as hard as the device displays, a simulated hand as it presses.
SceneLimits limits_on(const OpenDevice& opened, const PreparedCase& prepared);

/// \throws UsageError for a warning of these limits on hardware, unless the options permit it.
void refuse_unstable(const std::string& warning, const OpenDevice& opened, const SessionOptions& options);

/// The mapping and the functions of the buttons, for the user; one line.
std::string manner_text(const LoopSettings& settings);

/// Runs until it is over. The device is always left without force. \throws UsageError, IoError, DeviceAbsent
/// before the loop begins.
SessionResult run_session(const SessionOptions& options);

} // namespace forceshade::device
