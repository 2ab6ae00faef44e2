// A run of the live loop from the scene's file to the report: the loop, its log, a person at the terminal. Also what
// signals from outside do to it, and the check of a device before use.
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "device/loop/live_loop.h"
#include "device/run_report/report.h"
#include "device/session/readers.h"
#include "host/field/prepared_case.h"
#include "host/limits/limits.h"

namespace forceshade::device {

/// As asked for: the loop's rate is that or the device's, its samples follow from the duration.
struct SessionOptions : LoopSettings {
    std::filesystem::path scene;        // its file
    std::function<PreparedCase()> read; // makes a case of it, in the precision of the run
    /// Another law of the scene than make_probe_law, at the loop's period, s; empty: that one.
    std::function<std::unique_ptr<ProbeLaw>(const PreparedCase&, double period)> make_law{};
    std::string law{};                      // whose it is, for reports: "renderer mine"; empty: the scene's own
    std::string device = "sim";             // for open_device()
    bool origin_here = false;               // the mapping's origin is where the probe is at the start instead
    std::optional<double> asked_rate;       /* Hz */
    std::optional<double> duration;         /* s; none: until the recording ends or an interrupt */
    bool without_watchdog = false;          // a device's own, which may then display more than kUnwatchedForce
    std::optional<double> max_force;        /* N; of the limits: none: the device's, or kCautiousForce */
    std::optional<double> continuous_force; /* N: none: the device's */
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

/// ": " and the device's last error; empty: none.
std::string error_text_of(const BackEnd& device);

/// Whether the scene is stable on the device: pressed as hard as the device displays, a simulated hand as it presses.
SceneLimits limits_on(const OpenDevice& opened, const PreparedCase& prepared);

/// \throws UsageError for a warning of these limits on hardware, unless the options permit it.
void refuse_unstable(const std::string& warning, const OpenDevice& opened, const SessionOptions& options);

/// The mapping and the functions of the buttons, for the user; one line.
std::string manner_text(const LoopSettings& settings);

/// Runs until it is over. The device is always left without force. \throws UsageError, IoError, DeviceAbsent
/// before the loop begins.
SessionResult run_session(const SessionOptions& options);

/// While it lives, abort() (and with it an uncaught exception), a fault of memory or arithmetic, SIGQUIT and every
/// other unhandled signal that ends a process by default halt the device before the process ends as it would have.
/// (SIGKILL cannot be caught.) One at a time.
class Emergency {
public:
    explicit Emergency(BackEnd& back_end) noexcept;
    ~Emergency();
    Emergency(const Emergency&) = delete;
    Emergency& operator=(const Emergency&) = delete;
};

/// Handles a person's signals to a loop, while it lives. SIGINT, SIGTERM and SIGHUP keep their action (host/program.h)
/// and stop the loop in the handler, so that the next sample is the last; a second one ends the process by the signal,
/// after the device was halted. SIGTSTP, and SIGTTIN and SIGTTOU of a terminal that belongs to another job, stop the
/// process once the loop has displayed zero; when it goes on, the force ramps up as after the start. (SIGSTOP cannot be
/// caught: the device's own watchdog decides.) One at a time, within an Emergency.
class LoopSignals {
public:
    explicit LoopSignals(LiveLoop& loop) noexcept;
    ~LoopSignals();
    LoopSignals(const LoopSignals&) = delete;
    LoopSignals& operator=(const LoopSignals&) = delete;
};

/// absent: the device does not have it. skipped: it could not be done.
enum class CheckResult { passed, failed, skipped, absent };

struct CheckStep {
    std::string name; // "axes"
    CheckResult result = CheckResult::passed;
    std::string found;  // measured, with units
    std::string advice; // what to do; empty: no action
};

struct DeviceCheck {
    std::string time;      // UTC
    std::string asked_for; // --device
    DeviceFacts facts;
    std::string manner; // manner_text
    std::vector<CheckStep> steps;

    /// Every step passed, or the device does not have it.
    bool passed() const noexcept;
};

/// The person at the device, and messages to them.
struct CheckGuide {
    bool held = false;                                  // a hand holds the device: otherwise the check does not push
    std::function<void(const std::string& text)> print; // one line
    std::function<bool()> entered; // whether Enter was pressed since the last question; empty: no terminal
};

/// calibration, rest, axes (0.5 N along each of the scene's, the probe must yield along it), workspace (against the
/// scene's needs), watchdog (the loop stands still for a moment) and button, one after the other, by the live loop
/// with its safety: 0.5 N and 0.3 m/s at most. A simulated hand holds still where the path of the scene begins, above
/// the surface. The device is always left without force. \throws as open_for_loop; UsageError for a
/// recording; Interrupted.
DeviceCheck check_device(const SessionOptions& options, const PreparedCase& scene, const CheckGuide& guide);

/// A line a step, advice below.
std::string check_text(const DeviceCheck& check);

/// Keys: version, time, device (asked_for, name, software), manner, passed, steps (name, result, found, advice).
nlohmann::ordered_json check_json(const DeviceCheck& check);

// The scene's file while the loop runs: each time it is saved it becomes a new law.

class SceneChanges {
public:
    /// `read` makes a case of the file, and throws its errors. `first`: the case of the start. `stem`:
    /// scenes are kept as STEM.scene-N.toml, N the path that they begin, or nowhere if it is empty. `has_hand`: the
    /// first scene's hand moves the probe, and stays.
    SceneChanges(const std::filesystem::path& file, const std::function<PreparedCase()>& read,
                 const PreparedCase& first, std::filesystem::path stem, bool has_hand);

    /// Writes the scene of the start. \throws IoError.
    void keep_first() const { keep(used_.front()); }

    struct Message {
        std::string text;
        bool refused = false;
        std::optional<PreparedCase> used; // that the loop uses from now on
    };

    /// Checks the file now and then, hands a change over to the loop and keeps it; returns a message for the user, if
    /// any.
    std::optional<Message> look(LiveLoop& loop);

    /// Scenes that the loop has used, the first included.
    const std::vector<UsedScene>& used() const noexcept { return used_; }

private:
    using Stamp = std::pair<std::filesystem::file_time_type, std::uintmax_t>; // when it was written, its size

    Stamp stamp() const;
    PreparedCase read_again() const;
    std::string keep(const UsedScene& scene) const;

    const std::filesystem::path file_, stem_;
    const std::function<PreparedCase()> read_;
    const Scene first_;
    const bool has_hand_;
    Stamp last_, asked_; // of the last read, of the last check
    int looks_ = 0;
    std::vector<UsedScene> used_;
};

} // namespace forceshade::device
