// Which thread of a live run goes before which, where the system permits it.
#pragma once

#include <pthread.h>
#include <sched.h>

namespace forceshade::device {

/// Of SCHED_FIFO: the loop's, one that carries its forces to a device, the watchdog's, which both must not hold up.
inline constexpr int kCarrierPriority = 75, kLoopPriority = 80, kWatchdogPriority = 85;

/// For the calling thread; 0, or the reason why not (errno).
inline int raise_priority(int priority) noexcept {
    sched_param parameters{};
    parameters.sched_priority = priority;
    return ::pthread_setschedparam(::pthread_self(), SCHED_FIFO, &parameters);
}

} // namespace forceshade::device
