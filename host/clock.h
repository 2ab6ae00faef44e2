// How long something took, and when.
#pragma once

#include <algorithm>
#include <chrono>
#include <ctime>
#include <string>

#include <fmt/format.h>

namespace forceshade {

using Clock = std::chrono::steady_clock;

/// s.
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// s: of computing by this thread, without what it waits for.
inline double thread_seconds() {
    std::timespec time{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &time);
    return static_cast<double>(time.tv_sec) + 1e-9 * static_cast<double>(time.tv_nsec);
}

/// s: that reading the clock twice takes.
inline double clock_seconds() {
    double least = 1;
    for (int i = 0; i < 32; ++i) {
        const Clock::time_point start = Clock::now();
        least = std::min(least, seconds_since(start));
    }
    return least;
}

/// Adds the time that the work takes to `sum`, s.
template <typename Work> void timed(double& sum, const Work& work) {
    const Clock::time_point start = Clock::now();
    work();
    sum += seconds_since(start);
}

/// "2026-11-23T14:05:09Z"
inline std::string utc_now() {
    const std::time_t now = std::time(nullptr);
    std::tm parts{};
    ::gmtime_r(&now, &parts);
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", parts.tm_year + 1900, parts.tm_mon + 1, parts.tm_mday,
                       parts.tm_hour, parts.tm_min, parts.tm_sec);
}

} // namespace forceshade
