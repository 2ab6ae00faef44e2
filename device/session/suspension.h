// Ctrl-Z does not leave a device with a force that nobody watches over.
#pragma once

#include "device/loop/live_loop.h"

namespace forceshade::device {

/// While it lives, SIGTSTP, and SIGTTIN and SIGTTOU of a terminal that belongs to another job, stop the process once
/// the loop has displayed zero; when it goes on, the force comes up as after the start. (SIGSTOP cannot be caught: what
/// the device does then is its own watchdog's business.) One at a time.
class Suspension {
public:
    explicit Suspension(LiveLoop& loop) noexcept;
    ~Suspension();
    Suspension(const Suspension&) = delete;
    Suspension& operator=(const Suspension&) = delete;
};

} // namespace forceshade::device
