// Times besides those of an evaluation in a warm loop over many places. What a user runs, as a whole: a field over a
// grid with its file, by the grid's spacing, and a hand's strokes, by the loop's rate. And what a force costs where a
// hand waits for it: one evaluation at a time, in a loop that sleeps until its next sample, and with empty caches.
#pragma once

#include <vector>

#include "host/study/error_time/error_time.h"

namespace forceshade::study::error_time {

/// A field evaluated, compressed, written and checked against the oracle, as `forceshade field` does.
struct FieldRun {
    const Variant* variant = nullptr;
    std::string surface;
    GridSpec grid;
    std::string by; /* "kernel", "CPU on all cores", "CPU on one thread" */
    Precision precision = Precision::f32;
    Engine* engine = nullptr;
    double bytes = 0;              /* of the file */
    std::vector<double> seconds{}; /* a round each */
};

std::vector<FieldRun> field_runs(const Subject& subject, Engine& engine, Engine& single_thread);

/// Takes each once more, with a file in `folder` that is removed.
void measure(std::vector<FieldRun>& runs, const std::filesystem::path& folder);

/// Strokes of a hand that presses, in closed loop, on the CPU on one thread.
struct LoopRun {
    std::string surface;
    const Variant* variant = nullptr;
    double rate = 0; /* Hz */
    Precision precision = Precision::f32;
    double force_error = 0;    /* 1: RMS difference of the force from that at kFinestRate in double, over its RMS */
    double position_error = 0; /* m: RMS difference of the probe's position */
    double seconds = 0;        /* that a second of a stroke takes, median of the rounds */
};

/// Hz: 64 times the rate of most devices; its own error is about a quarter of that of the next rate shown.
inline constexpr double kFinestRate = 64000;

/// By rising rate, each in both precisions. `strokes` of `seconds` each; `rounds` of timing.
std::vector<LoopRun> loop_runs(const std::string& surface, const Variant& variant, Engine& single_thread,
                               std::size_t rounds);

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

struct OtherTimes {
    std::vector<FieldRun> fields;
    std::vector<LoopRun> loops;
    std::vector<AsMet> met;
};

/// Adds their tables, figures and findings.
void add_other_times(StudyData& data, const Measured& measured, const OtherTimes& others);

} // namespace forceshade::study::error_time
