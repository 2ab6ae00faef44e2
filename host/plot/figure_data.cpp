#include "host/plot/figure_data.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/plot/scale.h"
#include "host/study/data/data_error.h"
#include "host/study/data/data_files.h"

namespace forceshade::plot {
namespace {

constexpr int kSpokenDigits = 5;

std::size_t place_of(std::vector<std::string>& words, const std::string& word) {
    const auto found = std::ranges::find(words, word);
    if (found != words.end())
        return static_cast<std::size_t>(found - words.begin());
    words.push_back(word);
    return words.size() - 1;
}

// "stiffness / (N/m)" cut into name and unit.
std::pair<std::string, std::string> name_and_unit(const std::string& label) {
    const std::size_t slash = label.rfind(" / ");
    if (slash == std::string::npos)
        return {label, ""};
    std::string unit = label.substr(slash + 3);
    if (unit.size() > 2 && unit.front() == '(' && unit.back() == ')')
        unit = unit.substr(1, unit.size() - 2);
    return {label.substr(0, slash), unit == "1" ? "" : " " + unit};
}

} // namespace

std::vector<std::size_t> chosen_rows(const study::Table& table, const study::Where& where) {
    std::vector<std::size_t> columns;
    for (const auto& condition : where)
        columns.push_back(table.index(condition.first));
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        bool chosen = true;
        for (std::size_t i = 0; i < where.size() && chosen; ++i)
            chosen = study::cell_text(table.rows[row][columns[i]]) == where[i].second;
        if (chosen)
            rows.push_back(row);
    }
    return rows;
}

AxisData axis_data(const study::Table& table, const std::vector<std::size_t>& rows, std::string_view column) {
    if (column.empty())
        throw study::DataError(fmt::format("a figure of table {} has an axis without a column", table.name));
    const std::size_t index = table.index(column);
    AxisData data;
    const bool numbers = std::ranges::any_of(
        rows, [&](std::size_t row) { return std::holds_alternative<double>(table.rows[row][index]); });
    for (const std::size_t row : rows) {
        const study::Cell& cell = table.rows[row][index];
        if (const double* number = std::get_if<double>(&cell))
            data.values.emplace_back(*number);
        else if (const std::string* word = std::get_if<std::string>(&cell); word && !numbers)
            data.values.emplace_back(static_cast<double>(place_of(data.words, *word)));
        else
            data.values.emplace_back(std::nullopt);
    }
    return data;
}

AxisData word_data(const study::Table& table, const std::vector<std::size_t>& rows, std::string_view column) {
    const std::size_t index = table.index(column);
    AxisData data;
    for (const std::size_t row : rows)
        data.values.emplace_back(static_cast<double>(place_of(data.words, study::cell_text(table.rows[row][index]))));
    return data;
}

std::vector<std::optional<double>> optional_numbers(const study::Table& table, const std::vector<std::size_t>& rows,
                                                    std::string_view column) {
    std::vector<std::optional<double>> values;
    for (const std::size_t row : rows)
        values.push_back(column.empty() ? std::nullopt : table.number(row, column));
    return values;
}

SeriesData series_data(const study::Table& table, const std::vector<std::size_t>& rows, std::string_view column) {
    SeriesData data;
    if (column.empty()) {
        data.words = {""};
        data.of_row.assign(rows.size(), 0);
        return data;
    }
    const std::size_t index = table.index(column);
    for (const std::size_t row : rows)
        data.of_row.push_back(place_of(data.words, study::cell_text(table.rows[row][index])));
    return data;
}

std::vector<double> present(const std::vector<std::optional<double>>& values) {
    std::vector<double> numbers;
    for (const std::optional<double>& value : values)
        if (value)
            numbers.push_back(*value);
    return numbers;
}

std::string spoken(const std::string& axis_label, double value) {
    const auto [name, unit] = name_and_unit(axis_label);
    return fmt::format("{} = {}{}", name, number_label(value, kSpokenDigits), unit);
}

std::string spoken(const std::string& axis_label, const AxisData& axis, std::size_t i) {
    if (!axis.values[i])
        return name_and_unit(axis_label).first + ": none";
    if (!axis.words.empty())
        return axis.words[static_cast<std::size_t>(*axis.values[i])];
    return spoken(axis_label, *axis.values[i]);
}

} // namespace forceshade::plot
