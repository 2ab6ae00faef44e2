// Devices by the names that a user gives them.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "device/back_end.h"

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
