// Tables of rows: a row type and a list of its columns.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::study {

inline Cell cell_of(const std::optional<double>& value) {
    return value ? cell(*value) : Cell();
}

/// A column, and what stands in it of a row.
template <typename Row> struct ColumnOf {
    Column column;
    std::function<Cell(const Row&)> value;
};

/// A table with a row for each of `rows`.
template <typename Row>
Table table_of(std::string name, std::string title, const std::vector<ColumnOf<Row>>& columns,
               const std::vector<Row>& rows) {
    Table table{std::move(name), std::move(title), {}, {}};
    for (const ColumnOf<Row>& one : columns)
        table.columns.push_back(one.column);
    for (const Row& row : rows) {
        std::vector<Cell> cells;
        for (const ColumnOf<Row>& one : columns)
            cells.push_back(one.value(row));
        table.rows.push_back(std::move(cells));
    }
    return table;
}

} // namespace forceshade::study
