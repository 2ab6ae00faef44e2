#include "tests/device/report_cases.h"

#include <cmath>
#include <limits>
#include <random>

namespace forceshade::device::test {
namespace {

// Times about `middle` (ns), `spread` in natural logarithms, the same on every machine.
class Times {
public:
    std::int64_t next(double middle, double spread) {
        double sum = 0; // of twelve uniform numbers: close to normal
        for (int i = 0; i < 12; ++i)
            sum += static_cast<double>(random_() >> 11) * 0x1p-53;
        const double tail = random_() % 1000 == 0 ? 1.5 : 0;
        return static_cast<std::int64_t>(middle * std::exp(spread * (sum - 6) + tail));
    }

private:
    std::mt19937_64 random_{1};
};

void count(LoopCounts& counts, SampleFlag what, std::uint64_t samples) {
    counts.flags[static_cast<std::size_t>(std::countr_zero(static_cast<std::uint32_t>(what)))] = samples;
}

void fill(LiveOutcome& outcome, int samples) {
    Times times;
    LoopCounts& counts = outcome.counts;
    counts.samples = static_cast<std::uint64_t>(samples);
    counts.seconds = samples / outcome.rate;
    for (int i = 0; i < samples; ++i) {
        counts.computing.add(times.next(420, 0.12));
        counts.reading.add(times.next(35, 0.1));
        counts.writing.add(times.next(60, 0.1));
        if (outcome.real_time) {
            counts.late.add(times.next(12e3, 0.5));
            counts.jitter.add(times.next(3e3, 1.2));
        }
    }
}

} // namespace

LiveOutcome usual(double rate) {
    LiveOutcome outcome;
    outcome.scene = "bump.toml";
    outcome.precision = "f64";
    outcome.device = "sim";
    outcome.facts.name = "simulated hand";
    outcome.facts.max_force = 3.3;
    outcome.facts.simulated = true;
    outcome.rate = rate;
    fill(outcome, 60000);
    LoopCounts& counts = outcome.counts;
    counts.in_contact = 41230;
    counts.paths = 1;
    counts.waiting = 12;
    count(counts, kClamped, 12);
    count(counts, kRamping, 200);
    count(counts, kOverrun, 3);
    counts.largest_force = 3.214;
    counts.largest_commanded = 3;
    counts.largest_depth = 2.14e-3;
    counts.largest_speed = 0.251;
    counts.energy = -1.25e-3;
    counts.largest_energy = 3.4e-4;
    outcome.permissions.all = {
        {"SCHED_FIFO", false, "Operation not permitted; run as root, or set rtprio 80 in /etc/security/limits.conf"},
        {"memory lock", true, "all pages"},
        {"CPU pinning", true, "CPU 1"}};
    outcome.limits = {{"max_force", "3 N"}, {"max_slew", "1 N/ms"}, {"max_speed", "2 m/s"}, {"watchdog", "4 periods"}};
    outcome.log = "live.csv";
    outcome.logged = counts.samples;
    outcome.ended = "after 60 s";
    return outcome;
}

LiveOutcome as_fast_as_possible() {
    LiveOutcome outcome = usual(1000);
    outcome.real_time = false;
    outcome.counts = {};
    fill(outcome, 60000);
    outcome.counts.seconds = 0.031;
    outcome.permissions.all.clear();
    return outcome;
}

LiveOutcome one_sample() {
    LiveOutcome outcome = usual(1000);
    outcome.counts = {};
    fill(outcome, 1);
    outcome.counts.jitter = {};
    outcome.logged = 1;
    return outcome;
}

LiveOutcome no_sample() {
    LiveOutcome outcome;
    outcome.scene = "bump.toml";
    outcome.precision = "f32";
    outcome.device = "haply";
    outcome.rate = 1000;
    outcome.counts.waiting = 5000;
    outcome.counts.seconds = 5;
    outcome.ended = "the device gave no position";
    return outcome;
}

LiveOutcome talkative() {
    LiveOutcome outcome = usual(4000);
    outcome.scene =
        "a_study_of_bumps_whose_name_somebody_meant_to_tell_everything_in/" + std::string(120, 'x') + ".toml";
    outcome.device = "haply:ws://" + std::string(150, 'a') + ":10001";
    outcome.facts.name = "Inverse3 \xff\x1b[31m 04BA";
    outcome.facts.software = "Inverse Service 3.5.1";
    outcome.ended = "the device is gone: connection reset by peer while " + std::string(700, 'w') + " was sent";
    for (std::size_t i = 0; i < kSampleFlagNames.size(); ++i)
        outcome.counts.flags[i] = 1000 * i + 7;
    outcome.counts.damped = 2e-3;
    outcome.counts.lost = 17;
    outcome.sent_to = "udp:127.0.0.1:5005";
    outcome.sent = 59900;
    outcome.send_failure = "Connection refused: nobody listens there";
    outcome.remarks = {"the scene bump2.toml was refused: facets must be at least 1, got 0; the one before goes on",
                       "17 samples are missing in the log"};
    return outcome;
}

LiveOutcome beyond() {
    LiveOutcome outcome = usual(10000);
    for (Histogram* times : {&outcome.counts.computing, &outcome.counts.late, &outcome.counts.jitter}) {
        times->add(1);
        times->add(std::numeric_limits<std::int64_t>::max());
    }
    outcome.counts.largest_force = std::numeric_limits<double>::infinity();
    outcome.counts.energy = std::numeric_limits<double>::quiet_NaN();
    outcome.counts.largest_energy = 1e300;
    outcome.facts.max_force = kUnknown;
    return outcome;
}

std::vector<Case> cases() {
    return {{"usual", usual(1000)},     {"fast", as_fast_as_possible()}, {"one_sample", one_sample()},
            {"no_sample", no_sample()}, {"talkative", talkative()},      {"beyond", beyond()}};
}

} // namespace forceshade::device::test
