#include "host/study/stability/promises.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "host/study/stability/number_cases.h"

namespace forceshade::study {
namespace {

constexpr double kAccuracies[] = {1e-6, 1e-4, 1e-2};

struct Tried {
    double value;
    std::optional<double> error; /* none: there is no force */
    std::size_t row;             /* of the table */
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
        found->tried.push_back({*number.number(row, "value"), number.number(row, "error"), row});
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

Table failures_table(const Table& number) {
    constexpr double kAccuracy = 1e-4;
    Table table{"number_failures",
                "Where forces are first off by more than 1e-4 of the largest, and why",
                {{"surface", "", "Surface and shading."},
                 {"axis", "", "The parameter; all others are plain."},
                 {"precision", "", "f32 or f64."},
                 {"kept", "unit of the axis", "The last tried value at which they are not."},
                 {"lost", "unit of the axis", "The first tried value at which they are."},
                 {"error", "1", "Largest error over the largest force there; none: there is no field."},
                 {"predicted", "1", "What the conditions' formulas give for it."},
                 {"condition", "", "The rounding that weighs most, or why there is no field."}},
                {}};
    for (const Group& group : groups_of(number)) {
        const auto range = kept_range(group, kAccuracy);
        const auto add = [&](std::size_t kept, std::size_t lost) {
            const std::size_t row = group.tried[lost].row;
            const std::string refused = number.word(row, "refused");
            table.rows.push_back({group.surface, group.axis, group.precision, group.tried[kept].value,
                                  group.tried[lost].value, number.rows[row][number.index("error")],
                                  number.rows[row][number.index("predicted")],
                                  refused.empty() ? number.word(row, "condition") : "refused: " + refused});
        };
        if (range && range->first > 0)
            add(range->first, range->first - 1);
        if (range && range->second + 1 < group.tried.size())
            add(range->second, range->second + 1);
    }
    return table;
}

Table expected_table(const Table& number) {
    Table table{"number_expected",
                "What rounding lets one expect, the largest of all surfaces of a kind",
                {{"axis", "", "Which parameter is varied."},
                 {"precision", "", "f32 or f64."},
                 {"kind", "", "mesh, or analytic for all others."},
                 {"value_shown", "unit of the axis", "Its value, but 1e-4 for an origin of 0."},
                 {"predicted", "1", "Largest prediction of an error over the largest force."},
                 {"step_predicted", "1", "Likewise of the differences of neighbours."}},
                {}};
    std::map<std::tuple<std::string, std::string, std::string, double>, std::pair<double, double>> largest;
    for (std::size_t row = 0; row < number.rows.size(); ++row) {
        auto& [force, step] =
            largest[{number.word(row, "axis"), number.word(row, "precision"),
                     number.word(row, "surface") == "mesh" ? "mesh" : "analytic", *number.number(row, "value_shown")}];
        force = std::max(force, number.number(row, "predicted").value_or(0));
        step = std::max(step, number.number(row, "step_predicted").value_or(0));
    }
    for (const auto& [key, predicted] : largest) {
        const auto& [axis, precision, kind, value] = key;
        const auto shown = [](double number_here) { return number_here > 0 ? Cell(number_here) : Cell(); };
        table.rows.push_back({axis, precision, kind, value, shown(predicted.first), shown(predicted.second)});
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
        table.columns.push_back({axis.name, axis.unit == "1" ? "" : axis.unit,
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
