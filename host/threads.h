// How many threads the program computes with: decided here alone. Results do not depend on it.
#pragma once

#include <algorithm>
#include <atomic>
#include <thread>

#include <sched.h>

namespace forceshade {

namespace detail {
inline std::atomic<unsigned> thread_limit{0}; // 0: none
}

/// The CPUs that this process may run on: fewer than the machine has under taskset or in a cpuset.
inline unsigned allowed_cores() noexcept {
    static const unsigned cores = [] {
        cpu_set_t set;
        CPU_ZERO(&set);
        const int allowed = ::sched_getaffinity(0, sizeof set, &set) == 0 ? CPU_COUNT(&set) : 0;
        return allowed > 0 ? static_cast<unsigned>(allowed) : std::max(1u, std::thread::hardware_concurrency());
    }();
    return cores;
}

/// The most threads that work at a time on one thing: as --jobs says, else allowed_cores().
inline unsigned most_threads() noexcept {
    const unsigned limit = detail::thread_limit;
    return limit > 0 ? limit : allowed_cores();
}

/// For --jobs; before anything is computed.
inline void limit_threads(unsigned count) noexcept {
    detail::thread_limit = count;
}

} // namespace forceshade
