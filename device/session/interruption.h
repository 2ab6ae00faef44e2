// Ctrl-C ends the loop at once, and a second one the process, neither with a force on the device.
#pragma once

#include "device/loop/live_loop.h"

namespace forceshade::device {

/// While it lives, SIGINT, SIGTERM and SIGHUP do what they did (host/interrupt.h) and stop the loop in the handler, so
/// that the next sample is the last. A second one ends the process by the signal, after the device was halted. One at a
/// time, within an Emergency.
class Interruption {
public:
    explicit Interruption(LiveLoop& loop) noexcept;
    ~Interruption();
    Interruption(const Interruption&) = delete;
    Interruption& operator=(const Interruption&) = delete;
};

} // namespace forceshade::device
