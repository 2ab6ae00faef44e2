// The time that the live loop goes by: the monotonic clock, which nobody sets.
#pragma once

#include <cerrno>
#include <cstdint>
#include <ctime>

namespace forceshade::device {

inline constexpr std::int64_t kSecond = 1'000'000'000; /* ns */

inline std::int64_t now_of(clockid_t clock) noexcept {
    timespec time{};
    ::clock_gettime(clock, &time);
    return std::int64_t(time.tv_sec) * kSecond + time.tv_nsec;
}

/// ns, from an arbitrary beginning.
inline std::int64_t now() noexcept {
    return now_of(CLOCK_MONOTONIC);
}

/// ns that this thread has computed.
inline std::int64_t computed_so_far() noexcept {
    return now_of(CLOCK_THREAD_CPUTIME_ID);
}

/// Returns at a time of now(), or at once if it is over.
inline void sleep_until(std::int64_t time) noexcept {
    const timespec until{time / kSecond, static_cast<long>(time % kSecond)};
    while (::clock_nanosleep(CLOCK_MONOTONIC, TIMER_ABSTIME, &until, nullptr) == EINTR) {
    }
}

} // namespace forceshade::device
