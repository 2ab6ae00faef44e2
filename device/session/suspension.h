// Ctrl-Z does not leave a device with a force that nobody watches over.
#pragma once

#include "device/loop/live_loop.h"

namespace forceshade::device {

/// While it lives, SIGTSTP lets the loop take the force away before the process stops; when it goes on, the force comes
/// up as after the start. (SIGSTOP cannot be caught: what the device does then is its own watchdog's business.) One at
/// a time.
class Suspension {
public:
    /// `period`, s: of the loop.
    Suspension(LiveLoop& loop, double period) noexcept;
    ~Suspension();
    Suspension(const Suspension&) = delete;
    Suspension& operator=(const Suspension&) = delete;
};

} // namespace forceshade::device
