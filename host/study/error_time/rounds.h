// Times in paired rounds: each round measures every way once, in an order of its own, so that what disturbs the machine
// disturbs all alike; and what these rounds say for sure.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "host/study/error_time/ways.h"

namespace forceshade::study::error_time {

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

} // namespace forceshade::study::error_time
