// The stiffness at which a sampled loop just stops decaying, found by paths alone, beside what closed forms say.
#pragma once

#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/stability/loop_cells.h"

namespace forceshade::study {

/// By the growth of a small disturbance: ladders of stiffnesses, each within two rungs of the last one, then the zero
/// of the growth between two neighbours. N/m; nothing where all of the ladder decay or none. The cell's stiffness does
/// not matter.
std::optional<double> measured_limit(Engine& engine, const LoopPlace& place, const LoopCell& cell);

/// The hands and rates for which a place's limits are found.
std::vector<LoopCell> limit_cells(const LoopPlace& place, bool quick);

/// {limits, title, flat, pressed, precision, points: [{mass, damping, rate, delay, measured, wall, passive, linear,
/// own, flutter}]}; null: none. The scene's own stiffness stands where the loop is the scene's.
nlohmann::ordered_json limits_result(Engine& engine, const LoopPlace& place, const std::vector<LoopCell>& cells);

} // namespace forceshade::study
