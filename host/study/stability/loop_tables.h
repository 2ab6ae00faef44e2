// Results of the loops' steps as tables and figures.
#pragma once

#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// Every loop of every map, with what it came to and, where a closed form tells, what was expected.
Table map_table(const std::vector<nlohmann::ordered_json>& maps);
/// The closed forms drawn over the maps.
Table curve_table(const std::vector<nlohmann::ordered_json>& maps);
/// Limits found by paths beside closed forms.
Table limit_table(const std::vector<nlohmann::ordered_json>& limits);

/// What a reader must know of loops to read the numbers.
std::vector<std::string> loop_notes(const std::vector<nlohmann::ordered_json>& results);

/// How far limits lie from closed forms, and what surfaces bear over damping, with the closed
/// forms that the maps have.
std::vector<Figure> limit_figures(const std::vector<nlohmann::ordered_json>& limits,
                                  const std::vector<nlohmann::ordered_json>& maps);
/// A map each, with its curves.
std::vector<Figure> map_figures(const std::vector<nlohmann::ordered_json>& maps);

} // namespace forceshade::study
