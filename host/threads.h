// How many threads the program computes with: decided here alone. Results do not depend on it.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <functional>
#include <future>
#include <system_error>
#include <thread>
#include <vector>

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

/// Runs work(thread, index) for every index below count, shared out among threads; fewer, where no more are to be had.
/// \throws what one of them threw
template <typename Work> void share_out(std::size_t threads, std::size_t count, const Work& work) {
    std::atomic<std::size_t> next{0};
    std::vector<std::exception_ptr> failures(std::max<std::size_t>(threads, 1));
    const auto run = [&](std::size_t thread) {
        try {
            for (std::size_t i; (i = next++) < count;)
                work(thread, i);
        } catch (...) {
            failures[thread] = std::current_exception();
            next = count;
        }
    };
    {
        std::vector<std::jthread> helpers;
        try {
            for (std::size_t i = 1; i < threads; ++i)
                helpers.emplace_back(run, i);
        } catch (const std::system_error&) { // no more threads
        }
        run(0);
    }
    for (const std::exception_ptr& failure : failures)
        if (failure)
            std::rethrow_exception(failure);
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
