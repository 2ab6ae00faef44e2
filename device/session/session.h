// Safety's limits as a person reads them.
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "device/loop/live_loop.h"
#include "device/loop/outcome.h"
#include "device/loop/safety.h"
#include "device/session/open_device.h"
#include "host/prepare/prepared_case.h"

namespace forceshade::device {

/// By name, with units; "none" for a limit that is switched off.
std::vector<std::pair<std::string, std::string>> limits_as_text(const SafetyLimits& limits);

// A run of the live loop from the scene's file to the report: the loop, its log, a person at the terminal.

struct SessionOptions {
    std::filesystem::path scene;         // its file
    std::function<PreparedCase()> read;  // makes a case of it, in the precision of the run
    std::string device = "sim";          // as open_device() takes it
    Placement placement;                 // of the scene in the device\'s space
    std::optional<double> rate;          /* Hz */
    std::optional<double> duration;      /* s; none: until the recording ends or somebody interrupts */
    bool real_time = true;               // false: as fast as possible (sim and replay)
    std::optional<int> cpu;              // that the loop runs on
    double patience = 5;                 /* s: as in LoopSettings */
    std::optional<double> lasting_force; /* N: none: the device's */
    bool without_watchdog = false;       // a device's own, which may then display more than kUnwatchedForce
    std::optional<double> max_force;     /* N: none: what the device can, or kCautiousForce */
    SafetyLimits limits;                 // the others
    std::optional<std::pair<glm::dvec3, glm::dvec3>> workspace; /* m: none: the device's */
    std::filesystem::path log;                                  // empty: none
    bool replace_log = false;
    bool watch = false; // whether a change of the scene's file is taken up
    bool quiet = false;
};

/// How it ended, for the caller to make an exit code of.
struct SessionResult {
    LiveOutcome outcome;
    LoopEnd end = LoopEnd::stopped;
    bool interrupted = false;
    std::string complaint;   // of the device that is gone
    std::string log_failure; // why the log is not whole
};

/// Runs until it is over. Whatever happens, the device is left without force. \throws UsageError, IoError, DeviceAbsent
/// before the loop begins.
SessionResult run_session(const SessionOptions& options);

} // namespace forceshade::device
