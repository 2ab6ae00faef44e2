#include "host/study/data/study_data.h"

#include <algorithm>

#include <fmt/format.h>

namespace forceshade::study {

std::string Cell::text() const {
    if (const double* number = std::get_if<double>(this))
        return fmt::format("{}", *number);
    const std::string* word = std::get_if<std::string>(this);
    return word ? *word : std::string();
}

std::size_t Table::index(std::string_view column) const {
    const auto found = std::ranges::find(columns, column, &Column::name);
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

const Table& StudyData::table(std::string_view wanted) const {
    const auto found = std::ranges::find(tables, wanted, &Table::name);
    if (found == tables.end())
        throw DataError(fmt::format("the study {} has no table {}", study, wanted));
    return *found;
}

} // namespace forceshade::study
