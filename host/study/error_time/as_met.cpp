#include "host/study/error_time/as_met.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "host/clock.h"
#include "host/program.h"

namespace forceshade::study::error_time {
namespace {

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
    return {quantile(seconds, 0.5), quantile(seconds, 0.999), quantile(seconds, 1)};
}

std::vector<std::size_t> met_methods(const std::vector<Method>& methods) {
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < methods.size(); ++i) {
        const Method& method = methods[i];
        if (!method.once || !method.variant->thorough || method.variant->shading == "none")
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

std::vector<AsMet> measure_as_met(const std::vector<Method>& methods, const std::vector<std::size_t>& chosen,
                                  std::size_t ticks, std::size_t colds) {
    std::vector<AsMet> met{{AsMet::kControl, {}, {}, ticks, colds}};
    for (const std::size_t method : chosen)
        met.push_back({method, {}, {}, ticks, colds});
    std::vector<std::vector<double>> loop(met.size()), cold(met.size());
    const auto once = [&](const AsMet& one, std::size_t number) {
        return one.method == AsMet::kControl ? control() : methods[one.method].once(number);
    };
    for (const AsMet& one : met)
        once(one, 0); // makes volumes
    const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1 / kLoopRate));
    Clock::time_point next = Clock::now();
    for (std::size_t tick = 0; tick < ticks; ++tick) {
        check_interrupt();
        for (std::size_t i = 0; i < met.size(); ++i) {
            next += period;
            std::this_thread::sleep_until(next);
            loop[i].push_back(once(met[i], tick));
        }
    }
    std::vector<char> memory(kOtherMemory);
    for (std::size_t number = 0; number < colds; ++number) {
        check_interrupt();
        for (std::size_t i = 0; i < met.size(); ++i) {
            fill_caches(memory);
            cold[i].push_back(once(met[i], number));
        }
    }
    for (std::size_t i = 0; i < met.size(); ++i) {
        met[i].loop = waits_of(loop[i]);
        met[i].cold = waits_of(cold[i]);
    }
    return met;
}

bool was_busy(const std::vector<AsMet>& met) {
    return std::ranges::any_of(met, [](const AsMet& one) {
        return one.method == AsMet::kControl && (one.loop.median > 1e-6 || one.loop.p999 > 1e-4);
    });
}

Table met_table(const Measured& measured, const std::vector<AsMet>& met) {
    using R = AsMet;
    const auto nano = [](Waits R::*waits, double Waits::*seconds) {
        return [waits, seconds](const R& r) { return 1e9 * (r.*waits.*seconds); };
    };
    return table_of<R>(
        "as_met", "A force where a hand waits for it, one evaluation at a time",
        {{"way", "", "nothing: the clock read around nothing, the least that can be measured",
          [&](const R& r) { return name_of(measured, r); }},
         {"warm_ns", "ns", "an evaluation in a loop over many places",
          [&](const R& r) { return 1e9 * warm_seconds(measured, r); }},
         {"loop_p50_ns", "ns", "at 1 kHz, asleep between samples: the median", nano(&R::loop, &Waits::median)},
         {"loop_p99_9_ns", "ns", "the same, once in a thousand", nano(&R::loop, &Waits::p999)},
         {"loop_worst_ns", "ns", "the same, the worst", nano(&R::loop, &Waits::worst)},
         {"ticks", "1", "samples of that loop", [](const R& r) { return r.ticks; }},
         {"cold_p50_ns", "ns", "with caches full of other memory: the median", nano(&R::cold, &Waits::median)},
         {"cold_worst_ns", "ns", "the same, the worst", nano(&R::cold, &Waits::worst)},
         {"busy", "", "yes: the control itself waits too long for these times to say anything",
          [busy = was_busy(met)](const R&) { return busy ? "yes" : "no"; }}},
        met);
}

std::vector<Finding> met_findings(const Measured& measured, const std::vector<AsMet>& met) {
    if (was_busy(met))
        return {};
    const double clock = met.front().loop.median; // s: of the clock alone
    double least = INFINITY, worst = 0;           // 1: times as long as warm; s
    std::size_t methods = 0;
    for (const AsMet& one : met) {
        if (one.method == AsMet::kControl)
            continue;
        ++methods;
        least = std::min(least, std::max(one.loop.median - clock, 0.0) / warm_seconds(measured, one));
        worst = std::max(worst, one.loop.worst);
    }
    if (!(least >= 2 && least < INFINITY))
        return {};
    return {
        {"as_met",
         fmt::format("Waited for at 1 kHz, with sleeps between, every method's force takes at least {:.0f} times as "
                     "long as in a warm loop (median); the longest of all waits was {:.1g} % of a sample.",
                     std::floor(least), 100 * worst * kLoopRate),
         "", fmt::format("{} methods", methods), "one evaluation a millisecond, on a thread that sleeps between",
         fmt::format("{} samples and {} with empty caches of each method", met.front().ticks, met.front().colds)}};
}

} // namespace forceshade::study::error_time
