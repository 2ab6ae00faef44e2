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
    while (!stop.stop_requested()) {
        const std::int64_t fed = fed_.load(std::memory_order_relaxed), time = now();
        if (time - fed > patience_)
            back_end_.rest(); // again and again: the loop's thread may be within the vendor's library
        sleep_until(std::min(std::max(fed + patience_, time + patience_ / 4), time + kLongest));
    }
}

} // namespace forceshade::device
