// Timing in rounds: each measures every contender once, in an order of its own, so that what the machine does meanwhile
// falls on all of them.
#pragma once

#include <cstddef>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/error_time/contender.h"

namespace forceshade::study::error_time {

/// Seconds of an evaluation; the unit is a contender that is measured several times a round, its median counts.
struct Round {
    double unit = 0;
    std::vector<double> seconds; /* by contender */
};

/// `number` seeds the order. All were measured before, so that nothing is compiled or made within a round.
Round measure_round(const Contenders& contenders, std::size_t unit, std::size_t number);

nlohmann::ordered_json to_json(const Round& round);
Round round_from(const nlohmann::ordered_json& json);

} // namespace forceshade::study::error_time
