#include "host/study/stability/promises.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host/study/stability/number_cases.h"

namespace forceshade::study {
namespace {

constexpr double kAccuracies[] = {1e-6, 1e-4, 1e-2};

struct Tried {
    double value;
    std::optional<double> error; /* none: there is no force */
};

struct Group {
    std::string surface, axis, precision;
    std::vector<Tried> tried; /* ascending */
};

std::vector<Group> groups_of(const Table& number) {
    std::vector<Group> groups;
    for (std::size_t row = 0; row < number.rows.size(); ++row) {
        const std::string surface = number.word(row, "surface"), axis = number.word(row, "axis"),
                          precision = number.word(row, "precision");
        const auto same = [&](const Group& group) {
            return group.surface == surface && group.axis == axis && group.precision == precision;
        };
        auto found = std::ranges::find_if(groups, same);
        if (found == groups.end())
            found = groups.insert(found, {surface, axis, precision, {}});
        found->tried.push_back({*number.number(row, "value"), number.number(row, "error")});
    }
    for (Group& group : groups)
        std::ranges::sort(group.tried, {}, &Tried::value);
    return groups;
}

double base_of(const std::string& axis) {
    for (const NumberAxis& one : number_axes())
        if (one.name == axis)
            return one.base;
    return 0;
}

/// Indices of the first and last tried value that keep the accuracy, from the one nearest the plain value outwards;
/// nothing if that one does not.
std::optional<std::pair<std::size_t, std::size_t>> kept_range(const Group& group, double accuracy) {
    const double base = base_of(group.axis);
    const auto distance = [&](const Tried& one) {
        return base > 0 ? std::abs(std::log(std::max(one.value, 1e-300) / base)) : std::abs(one.value);
    };
    const auto keeps = [&](std::size_t i) { return group.tried[i].error && *group.tried[i].error <= accuracy; };
    std::size_t middle = 0;
    for (std::size_t i = 1; i < group.tried.size(); ++i)
        if (distance(group.tried[i]) < distance(group.tried[middle]))
            middle = i;
    if (group.tried.empty() || !keeps(middle))
        return std::nullopt;
    std::size_t low = middle, high = middle;
    while (low > 0 && keeps(low - 1))
        --low;
    while (high + 1 < group.tried.size() && keeps(high + 1))
        ++high;
    return std::pair(low, high);
}

} // namespace

Table promises_table(const Table& number) {
    Table table{
        "promises",
        "Which accuracy is kept in which range",
        {{"surface", "", "Surface and shading."},
         {"axis", "", "The parameter; all others are plain."},
         {"precision", "", "f32 or f64."},
         {"accuracy", "1", "Largest error over the largest force."},
         {"low", "unit of the axis", "Least tried value down to which it is kept; none: not even at the plain one."},
         {"high", "unit of the axis", "Largest tried value up to which it is kept."},
         {"tried_low", "unit of the axis", "Least value that was tried."},
         {"tried_high", "unit of the axis", "Largest value that was tried."}},
        {}};
    for (const Group& group : groups_of(number))
        for (const double accuracy : kAccuracies) {
            const auto range = kept_range(group, accuracy);
            table.rows.push_back({group.surface, group.axis, group.precision, accuracy,
                                  range ? Cell(group.tried[range->first].value) : Cell(),
                                  range ? Cell(group.tried[range->second].value) : Cell(), group.tried.front().value,
                                  group.tried.back().value});
        }
    return table;
}

Table promised_table(const Table& promises) {
    Table table{"promised",
                "Ranges of one parameter in which an accuracy is kept, the others plain",
                {{"surface", "", "Surface and shading."},
                 {"precision", "", "f32 or f64."},
                 {"accuracy", "1", "Largest error over the largest force."}},
                {}};
    for (const NumberAxis& axis : number_axes())
        table.columns.push_back({axis.name, "",
                                 fmt::format("Range of {}{}; a star: as far as was tried.", axis.meaning,
                                             axis.unit == "1" ? "" : " in " + axis.unit)});
    const auto row_for = [&](const std::string& surface, const std::string& precision, double accuracy) {
        for (std::size_t i = 0; i < table.rows.size(); ++i)
            if (table.word(i, "surface") == surface && table.word(i, "precision") == precision &&
                table.number(i, "accuracy") == accuracy)
                return i;
        table.rows.emplace_back(table.columns.size());
        table.rows.back()[0] = surface;
        table.rows.back()[1] = precision;
        table.rows.back()[2] = accuracy;
        return table.rows.size() - 1;
    };
    for (std::size_t row = 0; row < promises.rows.size(); ++row) {
        const std::size_t to =
            row_for(promises.word(row, "surface"), promises.word(row, "precision"), *promises.number(row, "accuracy"));
        const auto low = promises.number(row, "low"), high = promises.number(row, "high");
        const auto end = [&](double value, const char* tried) {
            return fmt::format("{:g}{}", value, promises.number(row, tried) == value ? "*" : "");
        };
        table.rows[to][table.index(promises.word(row, "axis"))] =
            low && high ? fmt::format("{} to {}", end(*low, "tried_low"), end(*high, "tried_high"))
                        : std::string("nowhere");
    }
    std::ranges::stable_sort(table.rows, {}, [&](const std::vector<Cell>& row) {
        return std::pair(std::get<std::string>(row[1]), std::get<double>(row[2]));
    });
    return table;
}

} // namespace forceshade::study
