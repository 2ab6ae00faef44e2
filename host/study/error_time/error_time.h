// The study of error against run time: the errors of methods by kinds of places, and their times in paired rounds. Each
// round measures every method once, in an order of its own, so that disturbances of the machine affect all alike.
#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <tuple>

#include "host/study/error_time/subject.h"
#include "host/study/study_run.h"

namespace forceshade::study {
namespace error_time {

/// Of a number over the draws of places, grid and mesh: least, median, largest. Empty without draws or without a
/// number.
template <typename Number> std::optional<Interval> over_draws(const MethodErrors& errors, const Number& number) {
    std::vector<double> values;
    for (const MethodErrors& one : errors.by_draw)
        if (const double value = number(one); !std::isnan(value))
            values.push_back(value);
    if (values.empty())
        return std::nullopt;
    return Interval{quantile(values, 0), quantile(values, 0.5), quantile(values, 1)};
}

/// Of a root mean square error.
inline std::optional<Interval> rms_over_draws(const MethodErrors& errors, Summary ForceErrors::*summary) {
    return over_draws(errors, [&](const MethodErrors& one) { return (one.shared.*summary).rms; });
}

/// Root mean square of vectors, or of how far they are from others.
double rms(const std::vector<glm::dvec3>& values, const std::vector<glm::dvec3>* less = nullptr);

/// Places by draw: what all laws of a surface share, and those of laws that differ in their shading alone; of the last
/// surface and number of elements.
struct KnownPlaces {
    const Subject* subject = nullptr;
    std::optional<double> elements{};
    std::vector<std::optional<SharedPlaces>> shared{};
    std::vector<std::optional<KindPlaces>> of_law{};
};

/// Measures the errors of every method of a law that has errors, over all draws; of a renderer of the first alone.
void add_errors(std::vector<Method>& methods, const Subject& subject, const Variant& variant, const Extents& extents,
                const Engines& engines, KnownPlaces& known);

/// Seconds of an evaluation, method by method.
using Round = std::vector<double>;

/// The numbers below `count`, in an order that follows from `number` (Fisher & Yates).
std::vector<std::size_t> shuffled(std::size_t count, std::size_t number);

/// Measures every method once, in an order that follows from the number of the round.
Round measure_round(std::span<const Method> methods, std::size_t number);

/// Comparisons of methods by their times in the same rounds.
class Times {
public:
    Times(std::vector<Round> rounds, std::size_t unit) : rounds_(std::move(rounds)), unit_(unit) {}

    /// s of an evaluation; its spread is that of the ratio to the unit in the same round, so that a slow-down of all
    /// methods does not count.
    Interval seconds(std::size_t method) const;
    /// Time of one method over that of another, in the same rounds.
    Interval ratio(std::size_t method, std::size_t other) const;
    /// Whether a method is significantly cheaper than another, in other runs, too: the interval of their ratio lies
    /// below 1.
    bool is_cheaper(std::size_t method, std::size_t other) const {
        return across_reruns(ratio(method, other)).high < 1;
    }

    const std::vector<Round>& rounds() const { return rounds_; }
    std::size_t unit() const { return unit_; }

private:
    std::vector<Round> rounds_;
    std::size_t unit_;                                                       /* method */
    mutable std::map<std::pair<std::size_t, std::size_t>, Interval> ratios_; /* asked for so far */
};

/// Of each method the share of 200 random samples of the rounds, with errors of a draw each and times that differ as
/// those of reruns do, in which none is as good by error and median time and better in one of them by 5 %. `errors`: by
/// method, one or one for each draw.
std::vector<double> front_shares(const Times& times, const std::vector<std::size_t>& methods,
                                 const std::vector<std::vector<double>>& errors);

/// The cheapest of some methods, and those that are not significantly slower.
struct Cheapest {
    std::size_t method = 0;        /* of the least median */
    std::vector<std::size_t> ties; /* others */
};
Cheapest cheapest_of(const Times& times, const std::vector<std::size_t>& methods);

struct Measured {
    const std::vector<Subject>& subjects;
    const std::vector<Method>& methods;
    const Times& times;
    Interval control{1, 1, 1};  /* the unit's time over its own in the same round */
    Interval crowding{1, 1, 1}; /* of all cores, over the rounds */

    /// Whether times say anything.
    bool steady() const { return !was_busy(control) && !was_busy(crowding); }

    /// The methods with errors for which a condition holds.
    template <typename Condition> std::vector<std::size_t> find(const Condition& condition) const {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < methods.size(); ++i)
            if (methods[i].errors && condition(methods[i]))
                found.push_back(i);
        return found;
    }
};

std::vector<Table> tables_of(const Measured& measured);
/// `own`: of the study's own surfaces.
std::vector<Figure> figures_of(const Measured& measured, bool own);
std::vector<Finding> findings_of(const Measured& measured);

/// Two tables, "fields" and "strokes", of some methods, numbers rounded: errors on a section across the middle of the
/// shape, and forces along a stroke there.
std::vector<Table> section_tables(std::span<const Method* const> methods);

/// The figures of these tables for a subject; `method`, one of its, is shown first.
std::vector<Figure> section_figures(const Subject& subject, const Method& method);

// Times besides those of an evaluation in a warm loop over many places. What a user runs, as a whole: a field over a
// grid with its file, by the grid's spacing, and a hand's strokes, by the loop's rate. And what a force costs where a
// hand waits for it: one evaluation at a time, in a loop that sleeps until its next sample, and with empty caches.

/// A field evaluated, compressed, written and checked against the oracle, as `forceshade field` does.
struct FieldRun {
    const Variant* variant = nullptr;
    std::string surface;
    GridSpec grid;
    std::string by; /* FieldEngine::name */
    Precision precision = Precision::f32;
    Engine* engine = nullptr;
    std::vector<std::string> words{}; /* FieldEngine::words */
    double bytes = 0;                 /* of the file */
    std::vector<double> seconds{};    /* a round each: of the field and its file */
    std::vector<double> starts{};     /* a round each: of the command with next to no field; none: not known */

    /// Of the whole command; without its start where that is not known.
    std::vector<double> whole() const;
};

struct FieldEngine {
    std::string name; /* "kernel", "kernel, every block", "CPU on all cores", "CPU on one thread" */
    Engine* engine;
    std::vector<std::string> words; /* that choose it on the command line */
    bool visits = false;            /* blocks of free space, too */

    bool fits(const Variant& variant, const GridSpec& grid, Precision precision) const;
};

std::vector<FieldRun> field_runs(const Subject& subject, const std::vector<FieldEngine>& engines);

/// Takes each once more, with a file in `folder` that is removed.
void measure(std::vector<FieldRun>& runs, const std::filesystem::path& folder);

/// Strokes of a hand that presses, in closed loop, on the CPU on one thread.
struct LoopRun {
    std::string surface;
    const Variant* variant = nullptr;
    double rate = 0; /* Hz */
    Precision precision = Precision::f32;
    double force_error = 0;    /* 1: RMS difference of the force from that of an ever faster loop, over its RMS */
    double median_error = 0;   /* 1: the same difference, median over the instants, over the RMS force */
    double position_error = 0; /* m: RMS difference of the probe's position */
    Interval by_stroke{};      /* 1: median_error of single strokes, median */
    double seconds = 0;        /* that a second of a stroke takes, median of the rounds */
};

/// Places that a batch evaluates at once.
inline constexpr std::size_t kBatch = 65536;

/// Hz: of the faster of the two loops from which the limit is extrapolated. A finer rate gains nothing: strokes advance
/// by whole 2^-32 of a round a step (`phase_of_turns`), which rounds their speed by up to 1e-5 there and 1e-4 at 1 MHz.
inline constexpr double kFinestRate = 64000;

/// By rising rate, each in both precisions; `rounds` of timing.
std::vector<LoopRun> loop_runs(const std::string& surface, const Variant& variant, Engine& single_thread,
                               std::size_t rounds);

/// s: of single evaluations.
struct Waits {
    Interval median{};
    double p99 = 0, p999 = 0, worst = 0;
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

/// Of each thorough law the direct evaluation and the god-object, of a shaded one each kind of look-up at its finest
/// spacing, too.
std::vector<std::size_t> met_methods(const std::vector<Method>& methods);

/// Methods take turns, one a tick, in an order of their own each time.
class AsMetTimes {
public:
    /// `methods` must outlive it.
    AsMetTimes(const std::vector<Method>& methods, const std::vector<std::size_t>& chosen);
    /// `ticks` and `colds` of each, after those so far.
    void measure(std::size_t ticks, std::size_t colds);
    /// The control first.
    std::vector<AsMet> result() const;

private:
    struct One {
        std::size_t method;
        std::vector<double> loop{}, cold{}; /* s */
    };
    double once(const One& one, std::size_t number) const;

    const std::vector<Method>& methods_;
    std::vector<One> met_; // the control of each of two loops, then the methods
};

/// Whether the machine was too busy for these times to say anything: a clock read around nothing takes a microsecond in
/// the median, or a tenth of a millisecond once in a thousand.
bool was_busy(const std::vector<AsMet>& met);

Table met_table(const Measured& measured, const std::vector<AsMet>& met);
/// None of a busy machine.
std::vector<Finding> met_findings(const Measured& measured, const std::vector<AsMet>& met);

struct OtherTimes {
    std::vector<FieldRun> fields;
    std::vector<LoopRun> loops;
    std::vector<AsMet> met;
};

/// Adds their tables, figures and findings.
void add_other_times(StudyData& data, const Measured& measured, const OtherTimes& others);

} // namespace error_time

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_error_time(StudyRun& run);

} // namespace forceshade::study
