#include "host/study/data/study_data.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/study/data/data_error.h"

namespace forceshade::study {

Cell cell(double value) {
    return std::isfinite(value) ? Cell(value) : Cell();
}

bool Table::has(std::string_view column) const {
    return std::ranges::any_of(columns, [&](const Column& one) { return one.name == column; });
}

std::size_t Table::index(std::string_view column) const {
    const auto found = std::ranges::find_if(columns, [&](const Column& one) { return one.name == column; });
    if (found != columns.end())
        return static_cast<std::size_t>(found - columns.begin());
    std::vector<std::string> names;
    for (const Column& one : columns)
        names.push_back(one.name);
    throw DataError(fmt::format("table {} has no column {}; it has {}", name, column, fmt::join(names, ", ")));
}

std::optional<double> Table::number(std::size_t row, std::string_view column) const {
    const double* value = std::get_if<double>(&rows.at(row)[index(column)]);
    return value ? std::optional(*value) : std::nullopt;
}

double Table::needed(std::size_t row, std::string_view column) const {
    if (const auto value = number(row, column))
        return *value;
    throw DataError(fmt::format("row {} of table {} has no {}", row + 1, name, column));
}

std::string Table::word(std::size_t row, std::string_view column) const {
    const std::string* value = std::get_if<std::string>(&rows.at(row)[index(column)]);
    return value ? *value : std::string();
}

const Table* StudyData::find(std::string_view table) const {
    const auto found = std::ranges::find_if(tables, [&](const Table& one) { return one.name == table; });
    return found == tables.end() ? nullptr : &*found;
}

const Table& StudyData::table(std::string_view name) const {
    if (const Table* found = find(name))
        return *found;
    throw DataError(fmt::format("the study {} has no table {}", study, name));
}

} // namespace forceshade::study
