// Rows of tables, out of values or out of objects whose keys are the columns' names.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/study/data/study_data.h"

namespace forceshade::study {

inline Cell cell_of(const std::optional<double>& value) {
    return value ? cell(*value) : Cell();
}
inline Cell cell_of(double value) {
    return cell(value);
}
inline Cell cell_of(const std::string& word) {
    return word;
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

/// A row's cells from values: words, numbers, or numbers that may be missing.
template <typename... Values> std::vector<Cell> row_of(const Values&... values) {
    return {cell_of(values)...};
}

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
