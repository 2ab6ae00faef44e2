// Signals from outside: none of them leaves a force on the device.
#pragma once

#include "device/loop/live_loop.h"

namespace forceshade::device {

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

} // namespace forceshade::device
