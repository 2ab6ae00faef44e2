// How long something took.
#pragma once

#include <chrono>

namespace forceshade {

using Clock = std::chrono::steady_clock;

/// s.
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

/// Adds the time that the work takes to `sum`, s.
template <typename Work> void timed(double& sum, const Work& work) {
    const Clock::time_point start = Clock::now();
    work();
    sum += seconds_since(start);
}

} // namespace forceshade
