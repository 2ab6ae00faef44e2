// A device whose own origin is not the scene's.
#pragma once

#include <memory>
#include <optional>

#include "device/back_end.h"

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
