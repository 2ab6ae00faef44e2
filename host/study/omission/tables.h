// The study's tables and figures, made of what its steps measured.
#pragma once

#include <nlohmann/json.hpp>

#include "host/study/data/study_data.h"
#include "host/study/omission/comparison.h"

namespace forceshade::study {

/// A row a comparison. `results`: of measure(), or {"skipped": why} which gives no row.
Table features_table(const std::vector<Comparison>& comparisons, const std::vector<nlohmann::ordered_json>& results);

/// What the manifests of the scenes say was left out, and which feature measures it: "not measured" if none does.
Table omitted_table(const std::vector<BaseScene>& scenes, const std::vector<Comparison>& comparisons);

std::vector<Figure> omission_figures(const Table& features);

} // namespace forceshade::study
