// Takes the force away while the live loop does not come round.
#pragma once

#include <atomic>
#include <cstdint>
#include <thread>

#include "device/back_end.h"

namespace forceshade::device {

/// A thread of its own, before the loop's if the system allows it: lets a device rest whose loop does not come round.
class Watchdog {
public:
    /// `patience`, ns: the longest time between two calls of feed().
    Watchdog(BackEnd& back_end, std::int64_t patience);
    ~Watchdog();

    void feed(std::int64_t now) noexcept { fed_.store(now, std::memory_order_relaxed); }

private:
    void run(const std::stop_token& stop) noexcept;

    BackEnd& back_end_;
    const std::int64_t patience_; /* ns */
    std::atomic<std::int64_t> fed_;
    std::jthread thread_;
};

} // namespace forceshade::device
