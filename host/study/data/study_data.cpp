#include "host/study/data/study_data.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/random.h"

namespace forceshade::study {
namespace {

double take_median(std::vector<double>& values) {
    const auto middle = values.begin() + static_cast<std::ptrdiff_t>(values.size() / 2);
    std::ranges::nth_element(values, middle);
    if (values.size() % 2 == 1)
        return *middle;
    return 0.5 * (*middle + *std::max_element(values.begin(), middle));
}

} // namespace

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

Interval bootstrap_median(const std::vector<double>& values) {
    constexpr std::size_t kResamples = 1000;
    if (values.empty())
        return {};
    std::vector<double> sample = values, medians;
    const double median = take_median(sample);
    Random draw(7);
    for (std::size_t i = 0; i < kResamples; ++i) {
        for (double& one : sample)
            one = values[static_cast<std::size_t>(draw(0, static_cast<double>(values.size())))];
        medians.push_back(take_median(sample));
    }
    std::ranges::sort(medians);
    return {medians[kResamples / 40], median, medians[kResamples - 1 - kResamples / 40]};
}

std::string times_as_long(const Interval& ratio, const char* other) {
    if (!is_significant(ratio))
        return fmt::format("takes about as long as {} (no significant difference: {:.2f} to {:.2f} times)", other,
                           ratio.low, ratio.high);
    return fmt::format("takes {:.2f} [{:.2f}, {:.2f}] times as long as {}", ratio.median, ratio.low, ratio.high, other);
}

double quantile(std::vector<double> values, double share) {
    if (values.empty())
        return 0;
    std::ranges::sort(values);
    const double rank = share * static_cast<double>(values.size() - 1);
    const auto below = static_cast<std::size_t>(rank);
    const std::size_t above = std::min(below + 1, values.size() - 1);
    return std::lerp(values[below], values[above], rank - static_cast<double>(below));
}

} // namespace forceshade::study
