#include "host/study/stability/loop_curves.h"

#include <functional>

#include "host/study/stability/loop_laws.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;
using Limit = std::function<std::optional<double>(const LoopCell&)>; // N/m

struct NamedLimit {
    const char *name, *label;
    bool dashed;
    Limit limit;
};

std::vector<NamedLimit> limits_of(const LoopPlace& place, const LoopMap& map) {
    const bool late = map.y.axis == LoopAxis::delay || map.nominal.hand.delay_samples > 0;
    std::vector<NamedLimit> limits;
    limits.push_back({"K_crit", late ? "K_crit, a sample late" : "K_crit", false, wall_limit});
    if (late)
        limits.push_back({"K_crit_prompt", "K_crit without delay", true, [](const LoopCell& cell) {
                              return critical_stiffness(cell.hand.mass, damping_of(cell), 1 / cell.rate);
                          }});
    limits.push_back(
        {"passive", late ? "passive: b = 3 K T / 2" : "passive: b = K T / 2", true, [](const LoopCell& cell) {
             return passive_stiffness(damping_of(cell), 1 / cell.rate, static_cast<int>(cell.hand.delay_samples));
         }});
    if (!place.flat)
        limits.push_back({"linear", "this surface, linearised", false, [&place](const LoopCell& cell) {
                              return linear_limit(linear_loop(place, cell.hand, cell.rate), 1e-3 * wall_limit(cell),
                                                  10 * wall_limit(cell));
                          }});
    if (flutter_stiffness(place.slope, 1, 1) && place.hand.grip_stiffness == 0)
        limits.push_back({"flutter", "flutter: b^2 sigma / (m omega^2)", true, [&place](const LoopCell& cell) {
                              return flutter_stiffness(place.slope, cell.hand.mass, damping_of(cell));
                          }});
    const HandSpec& hand = map.nominal.hand;
    if ((map.y.axis == LoopAxis::quantum || hand.quantisation > 0) &&
        (map.y.axis == LoopAxis::friction || hand.coulomb > 0))
        limits.push_back({"friction", "2 f_c / quantum", true, [](const LoopCell& cell) {
                              return friction_stiffness(cell.hand.coulomb, cell.hand.quantisation);
                          }});
    return limits;
}

constexpr int kPoints = 33; // of a curve

bool within(const LoopRange& range, double value) {
    return value >= range.low && value <= range.high;
}

// Over stiffness and something else: K as a function of that.
Json limit_curve(const LoopMap& map, const Limit& limit) {
    Json points = Json::array();
    for (int i = 0; i < kPoints; ++i) {
        const double y = map.y.at(double(i) / (kPoints - 1));
        const std::optional<double> stiffness = limit(with_value(map.nominal, map.y.axis, y));
        if (stiffness && within(map.x, *stiffness))
            points.push_back({rounded_to(*stiffness, 6), rounded_to(y, 6)});
    }
    return points;
}

// Over quantum and friction, for one stiffness: f_c = K quantum / 2.
Json friction_curve(const LoopMap& map) {
    Json points = Json::array();
    for (int i = 0; i < kPoints; ++i) {
        const double quantum = map.x.at(double(i) / (kPoints - 1)), friction = map.nominal.stiffness * quantum / 2;
        if (within(map.y, friction))
            points.push_back({rounded_to(quantum, 6), rounded_to(friction, 6)});
    }
    return points;
}

// With rounding and friction only a sufficient condition is known.
char expected_in(const LoopPlace& place, const LoopCell& cell, const std::optional<double>& limit) {
    const HandSpec& hand = cell.hand;
    if (!(hand.quantisation > 0) && !(hand.coulomb > 0))
        return limit && cell.stiffness >= *limit ? 'u' : 's';
    const double passive = passive_stiffness(damping_of(cell), 1 / cell.rate, static_cast<int>(hand.delay_samples));
    const bool held = !(hand.quantisation > 0) || cell.stiffness <= friction_stiffness(hand.coulomb, hand.quantisation);
    return place.flat && cell.stiffness <= passive && held ? 's' : '-';
}

std::optional<double> limit_in(const LoopPlace& place, const LoopCell& cell) {
    const double wall = wall_limit(cell);
    return place.flat ? wall : linear_limit(linear_loop(place, cell.hand, cell.rate), 1e-3 * wall, 10 * wall);
}

} // namespace

double wall_limit(const LoopCell& cell) {
    const auto limit = cell.hand.delay_samples > 0 ? critical_stiffness_late : critical_stiffness;
    return limit(cell.hand.mass, damping_of(cell), 1 / cell.rate);
}

Json curves_of(const LoopPlace& place, const LoopMap& map) {
    Json curves = Json::array();
    if (map.x.axis != LoopAxis::stiffness) {
        curves.push_back({{"name", "friction"},
                          {"label", "f_c = K quantum / 2"},
                          {"dashed", true},
                          {"points", friction_curve(map)}});
        return curves;
    }
    for (const NamedLimit& one : limits_of(place, map)) {
        Json points = limit_curve(map, one.limit);
        if (points.size() > 1)
            curves.push_back(
                {{"name", one.name}, {"label", one.label}, {"dashed", one.dashed}, {"points", std::move(points)}});
    }
    return curves;
}

Json expected_of(const LoopPlace& place, const LoopMap& map, const Json& xs, const Json& ys) {
    Json rows = Json::array();
    for (const Json& y : ys) {
        const LoopCell row = with_value(map.nominal, map.y.axis, y);
        const std::optional<double> limit = limit_in(place, row);
        std::string letters;
        for (const Json& x : xs)
            letters += expected_in(place, with_value(row, map.x.axis, x), limit);
        rows.push_back(letters);
    }
    return rows;
}

} // namespace forceshade::study
