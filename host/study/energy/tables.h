// Tables and figures of the study of energy, from the results of its steps.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// The words of column `group` of table `loops`.
inline constexpr const char* kGroups[] = {"bump", "mesh, nearest place", "mesh, god-object"};

/// Table `loops`: a row a loop (loop_row).
Table loops_table(const std::vector<nlohmann::ordered_json>& rows);
/// Table `laws`: what the laws print, beside what was found. Rows of `loops` that are not there are left out.
Table laws_table(const Table& loops);
/// Table `equal_error`: each scheme's row of `loops` with the fewest facets that keeps to a direction error.
Table equal_error_table(const Table& loops);
/// Table `front`: the loops of `loops` with a radius of 1000 mil that no other beats in both error and energy.
Table front_table(const Table& loops);
/// Tables `curl` (cells of the maps) and `curl_maps` (a row a map), from the maps' results.
Table curl_table(const std::vector<nlohmann::ordered_json>& maps);
Table curl_maps_table(const std::vector<nlohmann::ordered_json>& maps);

std::vector<Figure> loop_figures();
/// Of a user's scene.
std::vector<Figure> scene_figures();
std::vector<Figure> curl_figures(const std::vector<nlohmann::ordered_json>& maps);

} // namespace forceshade::study
