// The study of error against run time: the errors of methods by kinds of places, and their times in paired rounds. Each
// round measures every method once, in an order of its own, so that disturbances of the machine affect all alike.
#pragma once

#include <cmath>
#include <map>
#include <optional>
#include <span>
#include <tuple>

#include "host/study/error_time/methods.h"
#include "host/study/run/study_run.h"

namespace forceshade::study {
namespace error_time {

/// Of a number over the draws of a method's grid or mesh: least, median, largest. Empty without draws or without a
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

/// The places of laws that differ in their shading alone: by surface, elements and draw.
using KnownPlaces = std::map<std::tuple<const Subject*, std::optional<double>, std::size_t>, KindPlaces>;

/// Measures the errors of every method of a law that has errors; of those that depend on the draw, over all draws.
void add_errors(std::vector<Method>& methods, const Subject& subject, const Variant& variant, const Extents& extents,
                const Engines& engines, KnownPlaces& known);

/// Seconds of an evaluation, method by method.
using Round = std::vector<double>;

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
    /// Whether a method is significantly cheaper than another: the interval of their ratio lies below 1.
    bool is_cheaper(std::size_t method, std::size_t other) const { return ratio(method, other).high < 1; }

    const std::vector<Round>& rounds() const { return rounds_; }
    std::size_t unit() const { return unit_; }

private:
    std::vector<Round> rounds_;
    std::size_t unit_; /* method */
};

/// Of methods with errors, by rising error: each that is significantly cheaper than all on the front before it. NaN
/// errors are left out.
std::vector<std::size_t> front_of(const Times& times, const std::vector<std::size_t>& methods,
                                  const std::vector<double>& errors);

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

} // namespace error_time

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_error_time(StudyRun& run);

} // namespace forceshade::study
