#include "host/study/error_time/rounds.h"

#include <algorithm>
#include <numeric>

#include "host/study/run/quartiles.h"

namespace forceshade::study::error_time {
namespace {

constexpr std::size_t kUnitTimes = 7; // a round

// Fisher & Yates.
std::vector<std::size_t> shuffled(std::vector<std::size_t> order, std::size_t seed) {
    Draw draw(seed);
    for (std::size_t i = order.size(); i > 1; --i)
        std::swap(order[i - 1], order[static_cast<std::size_t>(draw(0, static_cast<double>(i)))]);
    return order;
}

} // namespace

Round measure_round(const Contenders& contenders, std::size_t unit, std::size_t number) {
    std::vector<std::size_t> order(contenders.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    order.insert(order.end(), kUnitTimes - 1, unit);
    Round round;
    round.seconds.resize(contenders.size());
    std::vector<double> units;
    for (const std::size_t i : shuffled(std::move(order), 1000 + number)) {
        const double seconds = contenders[i].seconds();
        (i == unit ? units.emplace_back() : round.seconds[i]) = seconds;
    }
    round.unit = quartiles(units).median;
    round.seconds[unit] = units[0];
    return round;
}

nlohmann::ordered_json to_json(const Round& round) {
    return {{"unit_s", round.unit}, {"seconds", round.seconds}};
}

Round round_from(const nlohmann::ordered_json& json) {
    return {json.at("unit_s"), json.at("seconds")};
}

} // namespace forceshade::study::error_time
