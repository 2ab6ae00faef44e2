#include "device/loop/watchdog.h"

#include <algorithm>

#include "device/loop/clock.h"
#include "device/priority.h"

namespace forceshade::device {

Watchdog::Watchdog(BackEnd& back_end, std::int64_t patience)
    : back_end_(back_end), patience_(patience), fed_(now()),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

Watchdog::~Watchdog() = default;

void Watchdog::run(const std::stop_token& stop) noexcept {
    constexpr std::int64_t kLongest = kSecond / 20; // between looks at `stop`
    raise_priority(kWatchdogPriority);
    std::int64_t bitten = 0; // the feeding after which it bit
    while (!stop.stop_requested()) {
        const std::int64_t fed = fed_.load(std::memory_order_relaxed), time = now();
        if (time - fed > patience_ && fed != bitten) {
            back_end_.rest();
            bitten = fed;
        }
        sleep_until(std::min(std::max(fed + patience_, time + patience_ / 4), time + kLongest));
    }
}

} // namespace forceshade::device
