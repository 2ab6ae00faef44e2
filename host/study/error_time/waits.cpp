// Forces waited for: one evaluation at a time, as a hand meets them, with their table and finding.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/program.h"
#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kLanes = 2;
constexpr std::size_t kOtherMemory = std::size_t(64) << 20; // B: more than caches hold

double control() {
    const Clock::time_point start = Clock::now();
    return seconds_since(start);
}

// Writes to memory of its own, so that caches hold nothing else.
void fill_caches(std::vector<char>& memory) {
    for (std::size_t at = 0; at < memory.size(); at += 64)
        ++memory[at];
}

std::string name_of(const Measured& measured, const AsMet& one) {
    return one.method == AsMet::kControl ? "nothing" : measured.methods[one.method].name;
}

double warm_seconds(const Measured& measured, const AsMet& one) {
    return one.method == AsMet::kControl ? NAN : measured.times.seconds(one.method).median;
}

} // namespace

Waits waits_of(const std::vector<double>& seconds) {
    return {bootstrap_median(seconds), quantile(seconds, 0.99), quantile(seconds, 0.999), quantile(seconds, 1)};
}

std::vector<std::size_t> met_methods(const std::vector<Method>& methods) {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        const Method& method = methods[i];
        const bool unshaded = method.variant->thorough && method.variant->shading == "none" && !method.spacing;
        if (!method.once || !(method.variant->is_main() || unshaded))
            continue;
        const bool finer = std::ranges::any_of(methods, [&](const Method& other) {
            return other.variant == method.variant && other.family == method.family &&
                   other.precision == method.precision && other.spacing < method.spacing;
        });
        if (!finer)
            chosen.push_back(i);
    }
    return chosen;
}

AsMetTimes::AsMetTimes(const std::vector<Method>& methods, const std::vector<std::size_t>& chosen)
    : methods_(methods), met_{{AsMet::kControl}, {AsMet::kControl}} {
    for (const std::size_t method : chosen)
        met_.push_back({method});
}

double AsMetTimes::once(const One& one, std::size_t number) const {
    return one.method == AsMet::kControl ? control() : methods_[one.method].once(number);
}

void AsMetTimes::measure(std::size_t ticks, std::size_t colds) {
    for (const One& one : met_)
        once(one, 0); // makes volumes
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / kLoopRate));
    const Clock::time_point start = Clock::now();
    const std::size_t first = met_[0].loop.size();
    // Two loops, each of half of the methods: both sleep nearly all the time.
    on_all_cores(kLanes, [&](std::size_t lane) {
        Clock::time_point next =
            std::max(start + static_cast<int>(lane) * period / static_cast<int>(kLanes), Clock::now());
        const std::size_t size = (met_.size() + kLanes - 1 - lane) / kLanes;
        for (std::size_t tick = first; tick < first + ticks; ++tick) {
            check_interrupt();
            for (const std::size_t i : shuffled(size, tick)) { // one warms what the next finds
                One& one = met_[kLanes * i + lane];
                next += period;
                std::this_thread::sleep_until(next);
                one.loop.push_back(once(one, tick));
            }
        }
    });
    std::vector<char> memory(kOtherMemory);
    for (std::size_t end = met_[0].cold.size() + colds; met_[0].cold.size() < end;) {
        check_interrupt();
        const std::size_t number = met_[0].cold.size();
        for (One& one : met_) {
            fill_caches(memory);
            one.cold.push_back(once(one, number));
        }
    }
}

std::vector<AsMet> AsMetTimes::result() const {
    std::vector<One> all(met_.begin() + 1, met_.end()); // the controls as one
    append(all[0].loop, met_[0].loop);
    append(all[0].cold, met_[0].cold);
    std::vector<AsMet> met;
    for (const One& one : all)
        met.push_back({one.method, waits_of(one.loop), waits_of(one.cold), one.loop.size(), one.cold.size()});
    return met;
}

bool was_busy(const std::vector<AsMet>& met) {
    return std::ranges::any_of(met, [](const AsMet& one) {
        return one.method == AsMet::kControl && (one.loop.median.median > 1e-6 || one.loop.p99 > 1e-5);
    });
}

Table met_table(const Measured& measured, const std::vector<AsMet>& met) {
    using R = AsMet;
    const auto nano = [](Waits R::*waits, double Waits::*seconds) {
        return [waits, seconds](const R& r) { return 1e9 * (r.*waits.*seconds); };
    };
    const auto median = [](Waits R::*waits, double Interval::*end) {
        return [waits, end](const R& r) { return 1e9 * ((r.*waits).median.*end); };
    };
    return table_of<R>(
        "as_met", "A force where a hand waits for it, one evaluation at a time",
        {{"way", "", "nothing: the clock read around nothing, the least that can be measured",
          [&](const R& r) { return name_of(measured, r); }},
         {"warm_ns", "ns", "an evaluation in a loop over many places",
          [&](const R& r) { return 1e9 * warm_seconds(measured, r); }},
         {"loop_p50_ns", "ns", "at 1 kHz, asleep between samples: the median", median(&R::loop, &Interval::median)},
         {"loop_p50_low_ns", "ns", "low end of its 95 % interval in this run; others differ by more",
          median(&R::loop, &Interval::low)},
         {"loop_p50_high_ns", "ns", "high end", median(&R::loop, &Interval::high)},
         {"loop_p99_ns", "ns", "the same, once in a hundred", nano(&R::loop, &Waits::p99)},
         {"loop_p999_ns", "ns", "the same, once in a thousand: of a thousand samples between the two worst",
          nano(&R::loop, &Waits::p999)},
         {"loop_worst_ns", "ns", "the same, the worst", nano(&R::loop, &Waits::worst)},
         {"ticks", "1", "samples of that loop", [](const R& r) { return r.ticks; }},
         {"cold_p50_ns", "ns", "with caches full of other memory: the median", median(&R::cold, &Interval::median)},
         {"cold_worst_ns", "ns", "the same, the worst", nano(&R::cold, &Waits::worst)},
         {"busy", "", "yes: the control itself waits too long for these times to say anything",
          [busy = was_busy(met)](const R&) { return busy ? "yes" : "no"; }}},
        met);
}

std::vector<Finding> met_findings(const Measured& measured, const std::vector<AsMet>& met) {
    if (was_busy(met))
        return {};
    const double clock = met.front().loop.median.median; // s: of the clock alone
    std::size_t methods = 0, longer = 0;
    for (const AsMet& one : met)
        if (one.method != AsMet::kControl) {
            ++methods;
            longer += one.loop.median.low - clock > measured.times.seconds(one.method).high;
        }
    if (methods == 0)
        return {};
    return {{"as_met",
             fmt::format("Waited for at 1 kHz, with sleeps between, a force takes significantly longer than in a warm "
                         "loop with {} of {} methods; how much longer differs from run to run. The times of the fronts "
                         "are those of fields and batches, and their order need not be that in a loop.",
                         longer, methods),
             "", fmt::format("{} methods", methods), "one evaluation a millisecond, on a thread that sleeps between",
             fmt::format("{} samples and {} with empty caches of each method", met.back().ticks, met.back().colds)}};
}

} // namespace forceshade::study::error_time
