// Maps of what sampled loops come to, over two of stiffness, damping, rate, delay, quantisation and friction.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/stability/loop_cells.h"

namespace forceshade::study {

/// What a map goes along.
enum class LoopAxis { stiffness, damping, rate, delay, quantum, friction };
inline constexpr std::size_t kLoopAxes = 6;

/// As tables and figures have it.
struct LoopAxisWords {
    const char* name;   /* "damping" */
    const char* column; /* "damping_N_s_per_m" */
    const char* unit;   /* of the column */
    const char* label;  /* of a figure's axis */
    double in_column;   /* what SI is multiplied with */
};
const LoopAxisWords& words_of(LoopAxis axis);

struct LoopRange {
    LoopAxis axis = LoopAxis::stiffness;
    double low = 1, high = 10; /* SI */
    std::size_t count = 2;     /* evenly in the logarithm */

    double at(double share) const; /* 0: low, 1: high */
};

struct LoopMap {
    std::string name; /* "plane-damping" */
    LoopRange x, y;
    LoopCell nominal; /* what does not vary */
    LoopRun run;
};

/// With so many significant digits: numbers that are chosen freely are chosen short.
double rounded_to(double value, int digits);

/// The cell with one of its values replaced; a delay is one sample, as long as it says.
LoopCell with_value(LoopCell cell, LoopAxis axis, double value);
/// What it is in a cell, SI.
double value_of(const LoopCell& cell, LoopAxis axis);

/// All maps of a place, coarser for `quick`.
std::vector<LoopMap> maps_of(const LoopPlace& place, bool quick);

/// Takes a map's loops through the engine; {map, place, axes and values, states a row, curves}.
nlohmann::ordered_json map_result(Engine& engine, const LoopPlace& place, const LoopMap& map);

} // namespace forceshade::study
