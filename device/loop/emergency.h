// A process that dies does not leave a device with a force.
#pragma once

#include "device/backends/back_end.h"

namespace forceshade::device {

/// While it lives, abort() (and with it an exception that nobody catches), a fault of memory or arithmetic, SIGQUIT and
/// every other signal that ends a process by default and that nobody else has taken halt the device before
/// the process ends as it would have. (SIGKILL cannot be caught.) One at a time.
class Emergency {
public:
    explicit Emergency(BackEnd& back_end) noexcept;
    ~Emergency();
    Emergency(const Emergency&) = delete;
    Emergency& operator=(const Emergency&) = delete;
};

/// In the handler of a signal that was taken by Emergency, or does what it does by default: halts the device that is
/// guarded, if there is one, and ends the process by the signal.
void halt_and_die(int signal);

} // namespace forceshade::device
