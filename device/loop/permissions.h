// What of the operating system's means for work in real time the live loop gets.
#pragma once

#include <optional>

#include "device/loop/outcome.h"

namespace forceshade::device {

/// For the calling thread, the live loop's: SCHED_FIFO, timers to the nanosecond, its CPU (`cpu`; where none is given
/// the last one that it may use, if it has SCHED_FIFO), all memory of the process locked.
Permissions ask_for_real_time(std::optional<int> cpu);

} // namespace forceshade::device
