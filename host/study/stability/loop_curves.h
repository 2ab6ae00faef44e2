// The closed forms that are drawn over a map.
#pragma once

#include <nlohmann/json.hpp>

#include "host/study/stability/loop_maps.h"

namespace forceshade::study {

/// K_crit of a cell's hand on a wall, with its delay, N/m.
double wall_limit(const LoopCell& cell);

/// Each {name, label, dashed, points: [[x, y], ...]}, within the map's ranges, SI.
nlohmann::ordered_json curves_of(const LoopPlace& place, const LoopMap& map);

/// What closed forms foresee of each cell, a word a row: s it comes to rest, u it does not, - they do not tell.
nlohmann::ordered_json expected_of(const LoopPlace& place, const LoopMap& map, const nlohmann::ordered_json& xs,
                                   const nlohmann::ordered_json& ys);

} // namespace forceshade::study
