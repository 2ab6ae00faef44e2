// The check of a device before use: its position, the direction of its forces, its workspace and its watchdog.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include <nlohmann/json_fwd.hpp>

#include "device/session/session.h"

namespace forceshade::device {

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
    bool somebody = false;                             // holds it: otherwise the check does not push
    std::function<void(const std::string& text)> tell; // prints one line
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

} // namespace forceshade::device
