#include "host/study/stability/loop_tables.h"

#include <cmath>
#include <string>

#include "host/study/stability/loop_maps.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

LoopAxis axis_of(const Json& range) {
    return static_cast<LoopAxis>(range.at("axis").get<std::size_t>());
}

LoopState state_of(char letter) {
    return static_cast<LoopState>(std::string_view("sqlu").find(letter));
}

void add_axes(std::vector<Column>& columns) {
    constexpr const char* kMeanings[kLoopAxes] = {
        "stiffness K of the surface",
        "damping b of device and hand together",
        "samples a second",
        "from measurement to force: none or one sample",
        "step of the measured position",
        "Coulomb friction on each axis",
    };
    for (std::size_t i = 0; i < kLoopAxes; ++i) {
        const LoopAxisWords& words = words_of(static_cast<LoopAxis>(i));
        columns.push_back({words.column, words.unit, kMeanings[i]});
    }
}

Cell number_or_nothing(const Json& value) {
    return value.is_null() ? Cell() : cell(value.get<double>());
}

// The six values of a cell of a map, in SI, with the map's two put in.
std::vector<Cell> axis_cells(const Json& map, double x, double y) {
    std::array<double, kLoopAxes> values{};
    for (std::size_t i = 0; i < kLoopAxes; ++i)
        values[i] = map.at("nominal").at(i);
    const auto at = [&](LoopAxis axis) -> double& { return values[static_cast<std::size_t>(axis)]; };
    const double delay = at(LoopAxis::delay) * at(LoopAxis::rate); // samples
    at(axis_of(map.at("x"))) = x;
    at(axis_of(map.at("y"))) = y;
    if (axis_of(map.at("y")) == LoopAxis::delay)
        at(LoopAxis::rate) = 1 / y;
    else
        at(LoopAxis::delay) = delay / at(LoopAxis::rate);
    std::vector<Cell> cells;
    for (std::size_t i = 0; i < kLoopAxes; ++i)
        cells.push_back(cell(values[i] * words_of(static_cast<LoopAxis>(i)).in_column));
    return cells;
}

void add_cells(Table& table, const Json& map) {
    const Json &xs = map.at("x").at("values"), &ys = map.at("y").at("values");
    for (std::size_t j = 0; j < ys.size(); ++j) {
        const std::string states = map.at("states").at(j), expected = map.at("expected").at(j);
        for (std::size_t i = 0; i < xs.size(); ++i) {
            std::vector<Cell> row{map.at("map").get<std::string>(), map.at("place").get<std::string>()};
            for (Cell& one : axis_cells(map, xs.at(i), ys.at(j)))
                row.push_back(std::move(one));
            row.emplace_back(std::string(word_of(state_of(states.at(i)))));
            const char foreseen = expected.at(i);
            row.push_back(foreseen == 's' ? Cell("rests") : foreseen == 'u' ? Cell("does not") : Cell());
            table.rows.push_back(std::move(row));
        }
    }
}

void add_curve(Table& table, const Json& map, const Json& curve) {
    const auto x = static_cast<std::size_t>(axis_of(map.at("x"))), y = static_cast<std::size_t>(axis_of(map.at("y")));
    for (const Json& point : curve.at("points")) {
        std::vector<Cell> row{map.at("map").get<std::string>(), curve.at("name").get<std::string>()};
        row.resize(2 + kLoopAxes);
        row[2 + x] = cell(point.at(0).get<double>() * words_of(static_cast<LoopAxis>(x)).in_column);
        row[2 + y] = cell(point.at(1).get<double>() * words_of(static_cast<LoopAxis>(y)).in_column);
        table.rows.push_back(std::move(row));
    }
}

std::vector<Cell> limit_row(const Json& limits, const Json& point) {
    const bool late = point.at("delay").get<int>() > 0;
    const std::string title = limits.at("title");
    const Json& pressed = limits.at("pressed");
    const Cell measured = number_or_nothing(point.at("measured")), wall = number_or_nothing(point.at("wall"));
    const Cell linear = number_or_nothing(point.at("linear"));
    const Cell& form = limits.at("flat").get<bool>() ? wall : linear;
    const auto over = [](const Cell& a, const Cell& b, double factor, double less) {
        const double *one = std::get_if<double>(&a), *other = std::get_if<double>(&b);
        return one && other ? cell(factor * (*one / *other - less)) : Cell();
    };
    const Cell off = over(measured, form, 100, 1);
    const double* size = std::get_if<double>(&off);
    return {limits.at("limits").get<std::string>(),
            title + (late ? ", a sample late" : ""),
            cell(point.at("mass")),
            cell(point.at("damping")),
            cell(point.at("rate")),
            cell(point.at("delay")),
            cell(pressed.at("grip")),
            cell(1e3 * pressed.at("depth").get<double>()),
            cell(1e3 * pressed.at("rest").at(0).get<double>()),
            cell(1e3 * pressed.at("rest").at(1).get<double>()),
            measured,
            form,
            off,
            size ? cell(std::abs(*size)) : Cell(),
            wall,
            number_or_nothing(point.at("passive")),
            over(measured, number_or_nothing(point.at("passive")), 1, 0),
            over(measured, wall, 1, 0),
            number_or_nothing(point.at("flutter")),
            number_or_nothing(point.at("own"))};
}

} // namespace

Table map_table(const std::vector<Json>& maps) {
    Table table{"loop_map", "What sampled loops come to", {}, {}};
    table.columns = {{"map", "", "which map the loop is of"}, {"surface", "", "what the hand is pressed into"}};
    add_axes(table.columns);
    table.columns.push_back(
        {"state", "",
         "stable: decays or comes to rest; one quantum: goes on, but the measured position changes by one quantum at "
         "most; limit cycle: goes on within the bound; unstable: leaves the bound"});
    table.columns.push_back(
        {"closed_form", "",
         "what is foreseen: of K_crit on the plane, of the linearised loop elsewhere; with rounding "
         "and friction only where K <= min(2 b / T, 2 f_c / quantum)"});
    for (const Json& map : maps)
        add_cells(table, map);
    return table;
}

Table curve_table(const std::vector<Json>& maps) {
    Table table{"loop_curves", "Closed forms drawn over the maps", {}, {}};
    table.columns = {{"map", "", "over which map"}, {"curve", "", "which closed form"}};
    add_axes(table.columns);
    for (const Json& map : maps)
        for (const Json& curve : map.at("curves"))
            add_curve(table, map, curve);
    return table;
}

Table limit_table(const std::vector<Json>& limits) {
    Table table{"loop_limits", "Stiffness at which loops stop decaying", {}, {}};
    table.columns = {
        {"surface", "", "what the hand is pressed into"},
        {"series", "", "surface, and whether the force comes late"},
        {"mass_kg", "kg", "mass of hand and device"},
        {"damping_N_s_per_m", "N s/m", "damping b of device and hand together"},
        {"rate_Hz", "Hz", "samples a second"},
        {"delay_samples", "1", "from measurement to force"},
        {"grip_N_per_m", "N/m", "spring that holds the probe sideways at its place"},
        {"depth_mm", "mm", "how deep the probe is pressed"},
        {"x_mm", "mm", "where on the surface"},
        {"y_mm", "mm", "where on the surface"},
        {"measured_N_per_m", "N/m", "stiffness at which a small disturbance neither grows nor decays along paths"},
        {"closed_form_N_per_m", "N/m", "K_crit on the plane, the limit of the linearised loop elsewhere"},
        {"disagreement_percent", "%", "of the measured limit with the closed form"},
        {"disagreement_size_percent", "%", "the same without its sign"},
        {"K_crit_N_per_m", "N/m", "K_crit of a wall with this hand, rate and delay"},
        {"passive_N_per_m", "N/m", "b / (T (1/2 + delay)): the largest passive stiffness of a wall"},
        {"over_passive_1", "1", "measured limit over the largest passive stiffness"},
        {"over_wall_1", "1", "measured limit over a wall's K_crit"},
        {"flutter_N_per_m", "N/m", "b^2 sigma / (m omega^2), for a force that is not held"},
        {"own_N_per_m", "N/m", "stiffness of the scene itself, where damping and delay are its own"},
    };
    for (const Json& one : limits)
        for (const Json& point : one.at("points"))
            table.rows.push_back(limit_row(one, point));
    return table;
}

} // namespace forceshade::study
