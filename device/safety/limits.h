// What the live loop may do to a person and a device.
#pragma once

#include <glm/vec3.hpp>

#include "device/back_end.h"

namespace forceshade::device {

/// On by default; an infinite limit is none. What is chosen where the user and the device say nothing.
struct SafetyLimits {
    double max_force = kUnknown;     /* N: larger forces keep their direction */
    double lasting_force = kUnknown; /* N: likewise what is displayed for longer, the root of its mean square */
    double slew = 2000;              /* N/s: how fast the force may come up; what it falls, it falls at once */
    double ramp = 0.2;               /* s: that the force takes to come up after the start and after a fault */
    double contact_ramp = 0.005;     /* s: likewise after contact is made again */
    double free_time = 0.05;         /* s: without contact, after which it is made again */
    double max_speed = 2;            /* m/s: of the probe */
    double stale = 0.02;             /* s: without a new position */
    double late = 20;                // periods that a sample may be late
    glm::dvec3 low{-kUnknown};       /* m: the workspace */
    glm::dvec3 high{kUnknown};       /* m */
    bool passivity = false;          // whether the passivity controller is on
    double damping = 10;             /* N s/m: the most that it may add */
};

/// Where neither the device nor the user says how much it may display, N.
inline constexpr double kCautiousForce = 3;

/// N: of a device without a watchdog of its own, which keeps the last force of a process that is killed.
inline constexpr double kUnwatchedForce = 0.5;

/// s: over which the mean square of a force is taken. No vendor states it; motors warm up in minutes.
inline constexpr double kLastingTime = 10;

} // namespace forceshade::device
