// A device whose own origin is not the scene's.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "device/backends/back_end.h"

namespace forceshade::device {

/// Where the scene's origin lies in the device's space.
struct Placement {
    bool here = false;    // where the probe is when it is opened
    glm::dvec3 origin{0}; /* m */
};

/// The device with positions and workspace in the scene's coordinates. \throws DeviceAbsent if the probe is to tell the
/// origin and the device tells no position within `patience`, s; Interrupted.
std::unique_ptr<BackEnd> place_device(std::unique_ptr<BackEnd> device, const Placement& placement, double patience);

} // namespace forceshade::device

// Devices by the names that a user gives them.

namespace forceshade {
struct PreparedCase;
}

namespace forceshade::device {

/// A device that is open, and the rate at which the loop goes if the user says none.
struct OpenDevice {
    std::unique_ptr<BackEnd> back_end;
    double rate = 1000;    /* Hz */
    std::string warning{}; // what the user should know of it
};

/// `name`: sim, replay:FILE, haply[:URL], dhd[:INDEX] or hd[:NAME]. `rate`, Hz: as the user says. `ramp`, s: that
/// forces take to come up, for which a simulated hand holds still. \throws UsageError for another name or a bad file,
/// DeviceAbsent, IoError.
OpenDevice open_device(const std::string& name, const PreparedCase& prepared, std::optional<double> rate, double ramp);

/// What a user may write for a device, in words.
inline constexpr const char* kDeviceNames = "sim, replay:FILE, haply[:URL], dhd[:INDEX] or hd[:NAME]";

} // namespace forceshade::device
