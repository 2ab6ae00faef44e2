#include "host/study/stability/number.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <tuple>

#include <fmt/format.h>

#include "host/study/data/rows.h"
#include "host/study/error_time/angle.h"
#include "host/study/stability/number_cases.h"
#include "host/study/stability/number_error.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kLeastShown = 1e-17; /* errors of 0 are shown there */

const std::vector<Column> kNumberColumns{
    {"surface", "", "Surface and shading; bump and mesh have 8 facets or cells where nothing else is said."},
    {"axis", "", "Which parameter is varied; all others are plain."},
    {"value", "unit of the axis", "Its value."},
    {"value_shown", "unit of the axis", "The value, but 1e-4 for an origin of 0, for logarithmic axes."},
    {"precision", "",
     "f32: the engine in single precision against the oracle in double; f64: the engine in double "
     "against closed forms and plain loops in extended precision."},
    {"series", "", "Surface and precision."},
    {"error", "1", "Largest error of a voxel's force, over the largest force."},
    {"error_shown", "1", "The same, but no less than 1e-17, for logarithmic axes."},
    {"predicted", "1", "What the conditions' formulas give for it, summed."},
    {"of_predicted", "1", "Error over prediction."},
    {"bound", "1", "The bound that validate holds to, coordinates rounded too; none of meshes."},
    {"direction_deg", "deg", "Largest angle between force and true force, where it is not below a thousandth."},
    {"off_voxels", "1", "Share of the voxels that are off by more than 1e-6 of the largest force."},
    {"step_error", "1", "Largest error of the difference of two neighbours along x, over the largest such difference."},
    {"step_predicted", "1", "What the formulas give for it."},
    {"condition", "", "The rounding that weighs most in the prediction."},
    {"refused", "", "Why there is no field; empty: there is."}};

Json row_json(const NumberCase& one, const char* precision, const NumberErrors& errors) {
    Json row{{"surface", one.surface}, {"axis", one.axis}, {"value", one.value}};
    row["value_shown"] = one.axis == "origin" ? std::max(one.value, 1e-4) : one.value;
    row["precision"] = precision;
    row["series"] = fmt::format("{}, {}", one.surface, precision);
    row["refused"] = errors.refused;
    if (!errors.refused.empty())
        return row;
    const auto number = [](double value) { return std::isfinite(value) ? Json(value) : Json(); };
    row["error"] = number(errors.force);
    row["error_shown"] = number(std::max(errors.force, kLeastShown));
    row["predicted"] = number(errors.predicted);
    row["of_predicted"] = number(errors.force / errors.predicted);
    row["direction_deg"] = number(errors.direction / kDegree);
    row["off_voxels"] = errors.share_off;
    if (errors.bound >= 0)
        row["bound"] = number(errors.bound);
    if (errors.step >= 0) {
        row["step_error"] = number(errors.step);
        row["step_predicted"] = number(errors.predicted_step);
    }
    row["condition"] = errors.condition;
    return row;
}

Json rows_of(Engine& engine, const std::string& surface, const std::string& axis, bool quick) {
    const double most_looped = surface == "mesh" ? 512 : 1e5; /* facets that a referee loops over in a short time */
    Json rows = Json::array();
    for (const double value : number_values(surface, axis, quick)) {
        const NumberCase one = number_case(surface, axis, value);
        rows.push_back(row_json(one, "f32", single_errors(engine, one)));
        if (engine.report().f64 && !(axis == "facets" && value > most_looped))
            rows.push_back(row_json(one, "f64", double_errors(engine, one)));
    }
    return rows;
}

Figure figure_of(const NumberAxis& axis) {
    Figure figure;
    figure.name = "number_" + axis.name;
    figure.title = fmt::format("Error of the force over {}", axis.meaning);
    figure.caption = "Largest error of a voxel's force over the largest force, each surface in single and double "
                     "precision; dashed: what the formulas of the conditions let one expect at most, of meshes "
                     "and of all other surfaces. A point that is missing "
                     "has no force in that precision. Errors of 0 are shown at 1e-17.";
    figure.kind = FigureKind::scatter;
    figure.table = "number";
    figure.where = {{"axis", axis.name}};
    figure.x = {"value_shown", axis.label, true};
    figure.y = {"error_shown", "largest error / largest force", true};
    figure.series = "series";
    figure.joined = true;
    return figure;
}

// The largest prediction of meshes and of all other surfaces, by axis, precision and value.
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

void add_curves(Figure& figure, const Table& expected, const std::string& axis, const char* column) {
    const auto has = [&](const std::string& kind, const std::string& precision) {
        for (std::size_t row = 0; row < expected.rows.size(); ++row)
            if (expected.word(row, "axis") == axis && expected.word(row, "kind") == kind &&
                expected.word(row, "precision") == precision && expected.number(row, column))
                return true;
        return false;
    };
    for (const auto& [kind, of] : {std::pair("analytic", ""), std::pair("mesh", " of meshes")})
        for (const char* precision : {"f32", "f64"})
            if (has(kind, precision))
                figure.curves.push_back({expected.name,
                                         {{"axis", axis}, {"precision", precision}, {"kind", kind}},
                                         "value_shown",
                                         column,
                                         fmt::format("expected at most{}, {}", of, precision),
                                         true});
}

Figure step_figure(const Table& expected) {
    Figure figure = figure_of(number_axes()[4]);
    figure.name = "number_steps";
    figure.title = "Error of the difference of neighbours over the spacing of the samples";
    figure.caption = "Forces stay good however fine the grid is; what is lost is the difference of two neighbours, "
                     "as soon as the spacing comes near the spacing of the numbers themselves, u |x|. At 1 nothing "
                     "of it is left.";
    figure.y = {"step_error", "error of a difference / largest difference", true};
    add_curves(figure, expected, "spacing", "step_predicted");
    return figure;
}

} // namespace

std::vector<Step> number_steps(StudyRun& run) {
    std::vector<Step> steps;
    const bool quick = run.options().quick;
    for (const std::string& surface : number_surfaces())
        for (const NumberAxis& axis : number_axes()) {
            if (number_values(surface, axis.name, quick).empty())
                continue;
            std::string name = fmt::format("number-{}-{}", surface, axis.name);
            std::ranges::replace_if(
                name, [](char c) { return c == ' ' || c == ','; }, '-');
            steps.push_back(
                {name, [&run, surface, axis, quick] { return rows_of(run.engine(), surface, axis.name, quick); }});
        }
    return steps;
}

void add_number(StudyData& data, const std::vector<Json>& results) {
    Table number{"number", "Where a precision leaves the truth", kNumberColumns, {}};
    for (const Json& result : results)
        for (const Json& row : result)
            number.rows.push_back(row_of(kNumberColumns, row));
    const Table expected = expected_table(number);
    data.tables.push_back(expected);
    for (const NumberAxis& axis : number_axes()) {
        Figure figure = figure_of(axis);
        add_curves(figure, expected, axis.name, "predicted");
        data.figures.push_back(std::move(figure));
    }
    data.figures.push_back(step_figure(expected));
    data.tables.push_back(std::move(number));
    data.notes.push_back("Samples over the axes of precision avoid edges, where rounding may choose either facet; the "
                         "worst places are searched for apart, in worst_rounding.");
}

} // namespace forceshade::study
