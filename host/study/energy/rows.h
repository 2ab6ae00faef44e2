// Tables out of objects whose keys are the columns' names.
#pragma once

#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/data/study_data.h"

namespace forceshade::study {

/// A cell for each column: a number, a word, or nothing where the object has none.
inline std::vector<Cell> row_of(const std::vector<Column>& columns, const nlohmann::ordered_json& object) {
    std::vector<Cell> row;
    for (const Column& column : columns) {
        const auto found = object.find(column.name);
        if (found == object.end() || found->is_null())
            row.emplace_back();
        else if (found->is_number())
            row.push_back(cell(found->get<double>()));
        else
            row.emplace_back(found->get<std::string>());
    }
    return row;
}

} // namespace forceshade::study
