// How many threads the program computes with: decided here alone. Results do not depend on it.
#pragma once

#include <algorithm>
#include <atomic>
#include <functional>
#include <future>
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

/// Does one piece of work after the other while whoever hands them in goes on; where no other thread is to be had, when
/// the next comes. Its end waits for what a thread does.
class OneBehind {
public:
    /// Waits for the piece before. \throws what that one threw.
    void add(std::function<void()> piece) {
        wait();
        constexpr auto kWhereThereIsOne = std::launch::async | std::launch::deferred;
        last_ = std::async(most_threads() > 1 ? kWhereThereIsOne : std::launch::deferred, std::move(piece));
    }
    void wait() {
        if (last_.valid())
            last_.get();
    }

private:
    std::future<void> last_;
};

} // namespace forceshade
