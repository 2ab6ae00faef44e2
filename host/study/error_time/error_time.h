// The study of error against run time. What is measured of ways: how far their forces are from what they should be, by
// kinds of places, and their times in paired rounds. Each round measures every way once, in an order of its own, so
// that what disturbs the machine disturbs all alike.
#pragma once

#include <cmath>

#include "host/study/error_time/places.h"
#include "host/study/error_time/ways.h"
#include "host/study/run/study_run.h"

namespace forceshade::study {
namespace error_time {

/// Root mean square, median, the value that 95 % do not exceed, and the largest.
struct Summary {
    double rms = 0, median = 0, p95 = 0, largest = 0;
};

/// Of values that are not negative; their order does not matter. Nothing of none.
std::optional<Summary> summary_of(std::vector<double> values);

/// Where there should be a force and none is, the local error is 1; out of contact a force has no direction.
struct ForceErrors {
    std::size_t places = 0;
    std::size_t missed = 0;           /* places where there should be a force, and none is */
    std::size_t phantom = 0;          /* places where there is a force, and none should be */
    std::optional<Summary> direction; /* deg */
    std::optional<Summary> local;     /* 1: |F - truth| / |truth|, where there should be a force */
    std::optional<Summary> typical;   /* 1: |F - truth| over the root mean square of the true force */

    /// What fronts and bounds are about: RMS of the direction's error in deg, and what 95 % of the local errors do not
    /// exceed; NaN where there is none, or where a force is missing at more than 1 % of the places.
    double bounded_direction() const { return whole() && direction ? direction->rms : NAN; }
    double bounded_local() const { return whole() && local ? local->p95 : NAN; }

private:
    bool whole() const { return double(missed) <= 0.01 * double(places); }
};

/// `forces` and `truth`, N, place by place; `typical`, N.
ForceErrors force_errors(std::span<const glm::dvec3> forces, std::span<const glm::dvec3> truth, double typical);

/// All that is told of a way's errors.
struct WayErrors {
    ForceErrors shared;                                            /* over the places that all laws share */
    std::array<std::optional<ForceErrors>, kKinds.size()> by_kind; /* nothing where there is no such place */
    std::optional<Summary> precision; /* 1: |F - same law in double| over the root mean square true force; all places */

    const ForceErrors* of(Kind kind) const {
        const auto& errors = by_kind[static_cast<std::size_t>(kind)];
        return errors ? &*errors : nullptr;
    }
};

/// Those of every way of a law that has errors, into `errors`, way by way.
void add_errors(std::vector<std::optional<WayErrors>>& errors, const std::vector<Way>& ways, const Subject& subject,
                const Variant& variant, const Extents& extents);

/// Seconds of an evaluation, way by way.
using Round = std::vector<double>;

/// Measures every way once, in an order that follows from the number of the round.
Round measure_round(std::span<const Way> ways, std::size_t number);

/// Comparisons of ways by what they took in the same rounds.
class Times {
public:
    Times(std::vector<Round> rounds, std::size_t unit) : rounds_(std::move(rounds)), unit_(unit) {}

    /// s of an evaluation; its spread is that of the ratio to the unit in the same round, so that what slows all ways
    /// alike does not count.
    Interval seconds(std::size_t way) const;
    /// Time of one way over that of another, in the same rounds.
    Interval ratio(std::size_t way, std::size_t other) const;
    /// Whether a way is cheaper than another for sure: the interval of their ratio lies below 1.
    bool is_cheaper(std::size_t way, std::size_t other) const { return ratio(way, other).high < 1; }

    const std::vector<Round>& rounds() const { return rounds_; }
    std::size_t unit() const { return unit_; }

private:
    std::vector<Round> rounds_;
    std::size_t unit_; /* way */
};

/// Of ways with errors, by rising error: each that is cheaper for sure than all on the front before it. Errors that are
/// no numbers never belong.
std::vector<std::size_t> front_of(const Times& times, const std::vector<std::size_t>& ways,
                                  const std::vector<double>& errors);

/// The cheapest of some ways, and those that these rounds do not tell from it.
struct Cheapest {
    std::size_t way = 0;           /* of the least median */
    std::vector<std::size_t> ties; /* others */
};
Cheapest cheapest_of(const Times& times, const std::vector<std::size_t>& ways);

struct Measured {
    const std::vector<Subject>& subjects;
    const std::vector<Way>& ways;
    const std::vector<std::optional<WayErrors>>& errors; /* way by way; nothing where it has none */
    const Times& times;

    /// The ways with errors for which a condition holds.
    template <typename Condition> std::vector<std::size_t> find(const Condition& condition) const {
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < ways.size(); ++i)
            if (errors[i] && condition(ways[i]))
                found.push_back(i);
        return found;
    }
};

std::vector<Table> tables_of(const Measured& measured);
/// `own`: of the study's own surfaces.
std::vector<Figure> figures_of(const Measured& measured, bool own);
/// What error against time says, in at most five sentences.
std::vector<Finding> findings_of(const Measured& measured);

} // namespace error_time

/// \throws what StudyRun::run throws, UsageError for a scene that the study cannot use.
StudyData study_error_time(StudyRun& run);

} // namespace forceshade::study
