// Permissions of the operating system for the live loop in real time.
#pragma once

#include <optional>
#include <string>
#include <vector>

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

} // namespace forceshade::device
