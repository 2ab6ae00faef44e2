// The live loop in real time: what the operating system permits it, how punctually this machine wakes it, and the
// settings that decide that.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "device/loop/sample.h"

namespace forceshade::device {

struct Permissions {
    struct One {
        std::string what; // "SCHED_FIFO"
        bool granted = false;
        std::string detail; // "priority 80", "Operation not permitted: ..." and a remedy
    };
    std::vector<One> all;
};

/// For the calling thread, the live loop's: SCHED_FIFO, timers to the nanosecond, its CPU (`cpu`; by default
/// the last one that it may use, if it has SCHED_FIFO), all memory of the process locked, no deep idle states.
Permissions ask_for_real_time(std::optional<int> cpu);

/// CPUs that this process may run on, in ascending order; empty: unknown.
std::vector<int> allowed_cpus();

struct WakeUps {
    Histogram late;         /* ns: after the period had begun */
    std::uint64_t lost = 0; // periods that were over before the loop woke
    double period = 0;      /* s */
    bool punctual() const noexcept { return lost == 0 && late.quantile(0.999) < 0.25e9 * period; }
};

/// The calling thread sleeps until each period of a loop begins, and does nothing else, for `seconds`.
WakeUps measure_wake_ups(double rate /* Hz */, double seconds) noexcept;

/// Kernel, throttling of real-time threads, processor's governor and idle states, free cores: what helps, or else what
/// to change.
std::vector<Permissions::One> real_time_settings();

} // namespace forceshade::device
