// How punctually this machine wakes a loop, and the settings that decide it.
#pragma once

#include <cstdint>
#include <vector>

#include "device/loop/permissions.h"
#include "device/loop/sample.h"

namespace forceshade::device {

struct WakeUps {
    Histogram late;         /* ns: after the period had begun */
    std::uint64_t lost = 0; // periods that were over before the loop woke
    double period = 0;      /* s */
    bool punctual() const noexcept { return lost == 0 && late.quantile(0.999) < 0.25e9 * period; }
};

/// The calling thread sleeps until each period of a loop begins, and does nothing else, for `seconds`.
WakeUps measure_wake_ups(double rate /* Hz */, double seconds) noexcept;

/// Kernel, throttling of real-time threads, processor's governor and idle states, free cores: what helps, or else what
/// to change.
std::vector<Permissions::One> real_time_settings();

} // namespace forceshade::device
