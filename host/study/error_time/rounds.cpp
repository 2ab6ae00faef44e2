#include "host/study/error_time/rounds.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace forceshade::study::error_time {

Round measure_round(std::span<const Way> ways, std::size_t number) {
    std::vector<std::size_t> order(ways.size());
    std::iota(order.begin(), order.end(), std::size_t(0));
    Draw draw(1000 + number);
    for (std::size_t i = order.size(); i > 1; --i) // Fisher & Yates
        std::swap(order[i - 1], order[static_cast<std::size_t>(draw(0, static_cast<double>(i)))]);
    Round round(ways.size());
    for (const std::size_t i : order)
        round[i] = ways[i].seconds();
    return round;
}

Interval Times::ratio(std::size_t way, std::size_t other) const {
    std::vector<double> ratios;
    for (const Round& round : rounds_)
        ratios.push_back(round[way] / round[other]);
    return bootstrap_median(ratios);
}

Interval Times::seconds(std::size_t way) const {
    std::vector<double> units;
    for (const Round& round : rounds_)
        units.push_back(round[unit_]);
    const double unit = quantile(units, 0.5);
    const Interval of_unit = ratio(way, unit_);
    return {of_unit.low * unit, of_unit.median * unit, of_unit.high * unit};
}

std::vector<std::size_t> front_of(const Times& times, const std::vector<std::size_t>& ways,
                                  const std::vector<double>& errors) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < ways.size(); ++i)
        if (std::isfinite(errors[i]))
            order.push_back(i);
    std::ranges::stable_sort(order, [&](std::size_t a, std::size_t b) {
        return errors[a] != errors[b] ? errors[a] < errors[b]
                                      : times.seconds(ways[a]).median < times.seconds(ways[b]).median;
    });
    std::vector<std::size_t> front;
    for (const std::size_t i : order)
        if (std::ranges::all_of(front, [&](std::size_t closer) { return times.is_cheaper(ways[i], closer); }))
            front.push_back(ways[i]);
    return front;
}

Cheapest cheapest_of(const Times& times, const std::vector<std::size_t>& ways) {
    Cheapest cheapest;
    cheapest.way = *std::ranges::min_element(ways, {}, [&](std::size_t way) { return times.seconds(way).median; });
    for (const std::size_t way : ways)
        if (way != cheapest.way && !times.is_cheaper(cheapest.way, way))
            cheapest.ties.push_back(way);
    return cheapest;
}

} // namespace forceshade::study::error_time
