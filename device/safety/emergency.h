// A process that dies does not leave a device with a force.
#pragma once

#include "device/back_end.h"

namespace forceshade::device {

/// While it lives, abort() (and with it an exception that nobody catches), a fault of memory or arithmetic, and SIGQUIT
/// halt the device before the process ends as it would have. One at a time.
class Emergency {
public:
    explicit Emergency(BackEnd& back_end) noexcept;
    ~Emergency();
    Emergency(const Emergency&) = delete;
    Emergency& operator=(const Emergency&) = delete;
};

} // namespace forceshade::device
