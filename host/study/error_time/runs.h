// What a user runs, as a whole: a field over a grid with its file, by the grid's spacing, and a hand's strokes, by the
// loop's rate.
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

std::vector<Table> run_tables(const Measured& measured, const std::vector<FieldRun>& fields,
                              const std::vector<LoopRun>& loops);
std::vector<Figure> run_figures(const std::vector<FieldRun>& fields, const std::vector<LoopRun>& loops);
std::vector<Finding> run_findings(const Measured& measured, const std::vector<FieldRun>& fields,
                                  const std::vector<LoopRun>& loops);

} // namespace forceshade::study::error_time
