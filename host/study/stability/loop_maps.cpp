#include "host/study/stability/loop_maps.h"

#include <array>
#include <cmath>

#include "host/study/stability/loop_curves.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<LoopAxisWords, kLoopAxes> kWords{{
    {"stiffness", "stiffness_N_per_m", "N/m", "stiffness / (N/m)", 1},
    {"damping", "damping_N_s_per_m", "N s/m", "damping / (N s/m)", 1},
    {"rate", "rate_Hz", "Hz", "rate / Hz", 1},
    {"delay", "delay_ms", "ms", "delay of one sample / ms", 1e3},
    {"quantum", "quantum_um", "um", "quantum of position / um", 1e6},
    {"friction", "friction_N", "N", "friction / N", 1},
}};

// How fine the maps of a place are.
struct Fineness {
    std::size_t columns, rows;
    double patience;
};

Fineness fineness_of(const LoopPlace& place, LoopAxis axis, bool quick) {
    const bool mesh = place.prepared.images.mesh != nullptr; // a hundred times dearer than other surfaces
    if (mesh)
        return quick ? Fineness{8, 4, 60} : Fineness{16, 8, 120};
    if (quick)
        return {16, 8, 200};
    return place.flat && axis == LoopAxis::damping ? Fineness{40, 20, 400} : Fineness{28, 14, 400};
}

LoopRange around(LoopAxis axis, double value, double low, double high, std::size_t count) {
    return {axis, low * value, high * value, count};
}

// Along y of a place's maps with the stiffness along x.
LoopRange row_range(const LoopPlace& place, LoopAxis axis, std::size_t count) {
    constexpr double kQuantum = 1e-5;  // m: where the hand has none
    constexpr double kFriction = 0.05; // N
    switch (axis) {
    case LoopAxis::rate:
        return around(axis, place.rate, 0.2, 10, count);
    case LoopAxis::delay:
        return around(axis, 1 / place.rate, 0.1, 5, count);
    case LoopAxis::quantum:
        return around(axis, place.hand.quantisation > 0 ? place.hand.quantisation : kQuantum, 0.1, 30, count);
    case LoopAxis::friction:
        return around(axis, place.hand.coulomb > 0 ? place.hand.coulomb : kFriction, 0.02, 20, count);
    default:
        return around(axis, place.hand.damping + place.hand.grip_damping, 0.2, 20, count);
    }
}

// The stiffnesses that maps of a place go along: about its limits, and about its own.
LoopRange stiffness_range(const LoopPlace& place, std::size_t count) {
    constexpr double kLow = 30, kHigh = 60000; // N/m: of the study's own
    LoopRange range{LoopAxis::stiffness, kLow, kHigh, count};
    if (place.stiffness > 0) {
        const double wall = wall_limit({place.hand, place.rate, 1});
        range.low = std::min(place.stiffness, wall) / 30;
        range.high = std::max(place.stiffness, wall) * 30;
    }
    return range;
}

// Friction and rounding belong together: without friction any rounding chatters, without rounding friction only helps.
LoopCell nominal_of(const LoopPlace& place, LoopAxis axis) {
    constexpr double kQuantum = 5e-5, kFriction = 0.1; // m, N
    LoopCell cell{place.hand, place.rate, place.stiffness > 0 ? place.stiffness : 1000};
    if (axis == LoopAxis::quantum && !(cell.hand.coulomb > 0))
        cell.hand.coulomb = kFriction;
    if (axis == LoopAxis::friction && !(cell.hand.quantisation > 0))
        cell.hand.quantisation = kQuantum;
    return cell;
}

LoopRun run_of(LoopAxis axis, double patience) {
    LoopRun run;
    run.patience = patience;
    if (axis == LoopAxis::quantum || axis == LoopAxis::friction)
        run.disturbance = 0.5; // friction holds still what is hardly moved
    return run;
}

Json range_json(const LoopRange& range) {
    Json values = Json::array();
    for (std::size_t i = 0; i < range.count; ++i)
        values.push_back(rounded_to(range.at(range.count > 1 ? double(i) / double(range.count - 1) : 0), 4));
    return {{"axis", static_cast<std::size_t>(range.axis)}, {"values", values}};
}

char letter_of(LoopState state) {
    return "sqlu"[static_cast<std::size_t>(state)];
}

} // namespace

const LoopAxisWords& words_of(LoopAxis axis) {
    return kWords[static_cast<std::size_t>(axis)];
}

double LoopRange::at(double share) const {
    return low * std::pow(high / low, share);
}

double rounded_to(double value, int digits) {
    if (value == 0)
        return 0;
    const double unit = std::pow(10.0, digits - 1 - std::floor(std::log10(std::abs(value))));
    return unit >= 1 ? std::round(value * unit) / unit : std::round(value * unit) * std::round(1 / unit);
}

LoopCell with_value(LoopCell cell, LoopAxis axis, double value) {
    switch (axis) {
    case LoopAxis::stiffness:
        cell.stiffness = value;
        break;
    case LoopAxis::damping:
        cell.hand.damping = value;
        cell.hand.grip_damping = 0;
        break;
    case LoopAxis::rate:
        cell.rate = value;
        break;
    case LoopAxis::delay:
        cell.rate = 1 / value;
        cell.hand.delay_samples = 1;
        break;
    case LoopAxis::quantum:
        cell.hand.quantisation = value;
        break;
    case LoopAxis::friction:
        cell.hand.coulomb = value;
        break;
    }
    return cell;
}

double value_of(const LoopCell& cell, LoopAxis axis) {
    switch (axis) {
    case LoopAxis::stiffness:
        return cell.stiffness;
    case LoopAxis::damping:
        return cell.hand.damping + cell.hand.grip_damping;
    case LoopAxis::rate:
        return cell.rate;
    case LoopAxis::delay:
        return static_cast<double>(cell.hand.delay_samples) / cell.rate;
    case LoopAxis::quantum:
        return cell.hand.quantisation;
    case LoopAxis::friction:
        break;
    }
    return cell.hand.coulomb;
}

std::vector<LoopMap> maps_of(const LoopPlace& place, bool quick) {
    std::vector<LoopMap> maps;
    for (const LoopAxis axis :
         {LoopAxis::damping, LoopAxis::rate, LoopAxis::delay, LoopAxis::quantum, LoopAxis::friction}) {
        if (quick && place.prepared.images.mesh && axis != LoopAxis::damping)
            continue;
        const Fineness fine = fineness_of(place, axis, quick);
        maps.push_back({place.name + "-" + words_of(axis).name, stiffness_range(place, fine.columns),
                        row_range(place, axis, fine.rows), nominal_of(place, axis), run_of(axis, fine.patience)});
    }
    const Fineness fine = fineness_of(place, LoopAxis::friction, quick);
    if (place.flat || place.stiffness > 0)
        maps.push_back({place.name + "-quantum-friction", row_range(place, LoopAxis::quantum, fine.columns),
                        row_range(place, LoopAxis::friction, fine.rows), nominal_of(place, LoopAxis::stiffness),
                        run_of(LoopAxis::friction, fine.patience)});
    return maps;
}

Json map_result(Engine& engine, const LoopPlace& place, const LoopMap& map) {
    Json result{{"map", map.name}, {"place", place.name}, {"title", place.title}, {"pressed", pressed(place)}};
    result["mass"] = map.nominal.hand.mass;
    result["x"] = range_json(map.x);
    result["y"] = range_json(map.y);
    result["states"] = Json::array();
    for (const Json& y : result["y"]["values"]) { // a row at a time, each as long as it takes
        std::vector<LoopCell> cells;
        for (const Json& x : result["x"]["values"])
            cells.push_back(with_value(with_value(map.nominal, map.y.axis, y), map.x.axis, x));
        std::string states;
        for (const LoopOutcome& outcome : run_cells(engine, place, cells, map.run))
            states += letter_of(outcome.state);
        result["states"].push_back(states);
    }
    result["expected"] = expected_of(place, map, result["x"]["values"], result["y"]["values"]);
    for (std::size_t i = 0; i < kLoopAxes; ++i)
        result["nominal"].push_back(value_of(map.nominal, static_cast<LoopAxis>(i)));
    result["curves"] = curves_of(place, map);
    return result;
}

} // namespace forceshade::study
