// Tables put together column by column.
#pragma once

#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study::error_time {

inline Cell cell_of(const std::optional<double>& value) {
    return value ? cell(*value) : Cell();
}
inline Cell cell_of(double value) {
    return cell(value);
}
inline Cell cell_of(const std::string& word) {
    return word;
}

/// A row's cells from values: words, numbers, or numbers that may be missing.
template <typename... Values> std::vector<Cell> row_of(const Values&... values) {
    return {cell_of(values)...};
}

} // namespace forceshade::study::error_time
