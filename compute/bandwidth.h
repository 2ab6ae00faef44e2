// How fast a device moves memory: what bounds a kernel whose results are written and read back.
#pragma once

#include "compute/device.h"

namespace forceshade::compute {

/// Bytes a second, the best of some tries.
struct Bandwidth {
    double store = 0;     /* filling a buffer of the device's */
    double copy = 0;      /* between two of them; each byte counts once */
    double read_back = 0; /* from one to memory of the host's, and read there */
};

/// Takes about a second. \throws DeviceError.
Bandwidth measure_bandwidth(Device& device);

} // namespace forceshade::compute
