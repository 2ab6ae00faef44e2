// How long something took.
#pragma once

#include <chrono>

namespace forceshade {

using Clock = std::chrono::steady_clock;

/// s.
inline double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

} // namespace forceshade
