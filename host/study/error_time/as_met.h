// What a force costs where a hand waits for it: one evaluation at a time, in a loop that sleeps until its next sample,
// and with empty caches; and in a warm loop over many places.
#pragma once

#include <vector>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {

/// s: of single evaluations.
struct Waits {
    double median = 0, p999 = 0, worst = 0;
};
Waits waits_of(const std::vector<double>& seconds);

/// A method as met; without a method, the control: reading the clock around nothing.
struct AsMet {
    std::size_t method = 0; /* of the study's; kControl */
    Waits loop;             /* at kLoopRate, asleep in between */
    Waits cold;             /* with caches that hold other memory */
    std::size_t ticks = 0, colds = 0;

    static constexpr std::size_t kControl = SIZE_MAX;
};

inline constexpr double kLoopRate = 1000; /* Hz */

/// Of each thorough, shaded law the direct evaluation, the god-object and each kind of look-up at its finest spacing.
std::vector<std::size_t> met_methods(const std::vector<Method>& methods);

/// Takes turns, a method a tick, the control first; `ticks` and `colds` of each.
std::vector<AsMet> measure_as_met(const std::vector<Method>& methods, const std::vector<std::size_t>& chosen,
                                  std::size_t ticks, std::size_t colds);

/// Whether the machine was too busy for these times to say anything: a clock read around nothing takes a microsecond in
/// the median, or a tenth of a millisecond once in a thousand.
bool was_busy(const std::vector<AsMet>& met);

Table met_table(const Measured& measured, const std::vector<AsMet>& met);
/// How much longer than warm at least; none where the machine was busy, or that is less than twice.
std::vector<Finding> met_findings(const Measured& measured, const std::vector<AsMet>& met);

} // namespace forceshade::study::error_time
