// What a device is taken to lack although it has it, so that tests on software devices meet what hardware lacks.
#pragma once

#include <cstdint>
#include <string_view>

#include "compute/device.h"

namespace forceshade::compute {

inline constexpr const char* kLimitsVariable = "FORCESHADE_DEVICE_LIMITS";

/// 0: as the device is.
struct DeviceLimits {
    bool no_f64 = false, no_int64 = false;
    bool no_float_controls = false;      /* kernels ask for none */
    bool flush = false;                  /* floats flush denormals to 0: taken for hardware, with bounds for bits */
    bool incoherent = false;             /* the host writes and reads mapped memory through flushing and invalidating */
    std::uint64_t memory = 0;            /* bytes: of the device's own memory, which the host does not see */
    std::uint64_t buffer_range = 0;      /* bytes that one storage buffer may span */
    std::uint32_t group_invocations = 0; /* most of a work group */
    std::uint64_t lost_at = 0;           /* at this submission, from 1, the device is lost */
    std::uint64_t short_at = 0;          /* this buffer, from 1, finds no memory, once */
    double longest = 0; /* s: a dispatch that takes longer loses the device, as drivers' time-outs do */
};

/// "no-f64,memory=268435456,lost-at=3". \throws DeviceError (unsupported).
DeviceLimits read_device_limits(std::string_view text);

/// Those of the environment's FORCESHADE_DEVICE_LIMITS.
DeviceLimits device_limits();

/// Lowers what the report says of the device.
void apply(const DeviceLimits& limits, DeviceReport& report);

} // namespace forceshade::compute
