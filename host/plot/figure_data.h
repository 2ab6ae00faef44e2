// What a figure shows of its table: rows, numbers and words along its axes, series.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "host/study/data/study_data.h"

namespace forceshade::plot {

/// In the table's order. \throws study::DataError if a column is missing, as all of these.
std::vector<std::size_t> chosen_rows(const study::Table& table, const study::Where& where);

/// Row by row: the number, or the place of the word among `words`, or nothing.
struct AxisData {
    std::vector<std::optional<double>> values;
    std::vector<std::string> words; /* empty: numbers */
};

/// Words where the rows hold words alone; a word among numbers is nothing.
AxisData axis_data(const study::Table& table, const std::vector<std::size_t>& rows, std::string_view column);

/// The same with every number taken as a word, as CSV prints it.
AxisData word_data(const study::Table& table, const std::vector<std::size_t>& rows, std::string_view column);

/// Of a spread's end; nothing throughout where the column's name is empty.
std::vector<std::optional<double>> optional_numbers(const study::Table& table, const std::vector<std::size_t>& rows,
                                                    std::string_view column);

/// The words of a column, the first to come first; one empty word where the column's name is empty.
struct SeriesData {
    std::vector<std::string> words;
    std::vector<std::size_t> of_row; /* index of words */
};
SeriesData series_data(const study::Table& table, const std::vector<std::size_t>& rows, std::string_view column);

/// Of the numbers that are there.
std::vector<double> present(const std::vector<std::optional<double>>& values);

/// "stiffness = 0.25 N/m" of an axis label "stiffness / (N/m)"; words stand for themselves.
std::string spoken(const std::string& axis_label, const AxisData& axis, std::size_t i);
std::string spoken(const std::string& axis_label, double value);

} // namespace forceshade::plot
