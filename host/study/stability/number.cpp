#include "host/study/stability/number.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/study/data/study_data.h"
#include "host/study/error_time/angle.h"

namespace forceshade::study {
namespace {

constexpr double kLeastShown = 1e-17; /* errors of 0 are shown there */
constexpr double kOriginShown = 1e-4; /* m: where an origin of 0 is shown */

Figure number_figure(const NumberAxis& axis) {
    Figure figure;
    figure.name = "number_" + axis.name;
    figure.title = fmt::format("Error of the force over {}", axis.meaning);
    figure.caption =
        "Largest error of a voxel's force over the largest force, away from edges. A point that is missing "
        "has no force in that precision. Errors of 0 are shown at 1e-17.";
    figure.table = "number";
    figure.where = {{"axis", axis.name}};
    figure.x = {"value_shown", axis.label, true};
    figure.y = {"error_shown", "largest error / largest force", true};
    figure.series = "series";
    figure.joined = true;
    return figure;
}

const NumberAxis& axis_named(const char* name) {
    return *std::ranges::find(number_axes(), name, &NumberAxis::name);
}

} // namespace

std::vector<Part> number_parts(Engine& engine, bool quick, std::vector<NumberRow>& rows) {
    std::vector<Part> parts;
    for (const std::string& surface : number_surfaces())
        for (const NumberAxis& axis : number_axes()) {
            if (number_values(surface, axis.name, quick).empty())
                continue;
            parts.push_back({fmt::format("numbers: {} over {}", surface, axis.name),
                             [&engine, &rows, surface, quick, name = axis.name] {
                                 const double most_looped =
                                     surface == "mesh" ? 512 : 1e5; /* facets that a referee takes a short time for */
                                 for (const double value : number_values(surface, name, quick)) {
                                     const NumberCase one = number_case(surface, name, value);
                                     rows.push_back({surface, name, value, "f32", single_errors(engine, one)});
                                     if (engine.report().f64 && !(name == "facets" && value > most_looped))
                                         rows.push_back({surface, name, value, "f64", double_errors(engine, one)});
                                 }
                             }});
        }
    return parts;
}

void add_numbers(StudyData& data, const std::vector<NumberRow>& rows) {
    using R = NumberRow;
    const auto number = [](double NumberErrors::*of) {
        return [of](const R& r) { return r.errors.refused.empty() && r.errors.*of >= 0 ? cell(r.errors.*of) : Cell(); };
    };
    data.tables.push_back(table_of<R>(
        "number", "Where a precision leaves the truth",
        {{{"surface", "", "Surface and shading; bump and mesh have 8 facets or cells where nothing else is said."},
          [](const R& r) { return Cell(r.surface); }},
         {{"axis", "", "Which parameter is varied; all others are plain."}, [](const R& r) { return Cell(r.axis); }},
         {{"value", "unit of the axis", "Its value."}, [](const R& r) { return cell(r.value); }},
         {{"value_shown", "unit of the axis", "The value, but 1e-4 for an origin of 0, for logarithmic axes."},
          [](const R& r) { return cell(r.axis == "origin" ? std::max(r.value, kOriginShown) : r.value); }},
         {{"precision", "",
           "f32: the engine in single precision against the oracle in double; f64: the engine in double against "
           "closed forms and plain loops in extended precision."},
          [](const R& r) { return Cell(r.precision); }},
         {{"series", "", "Surface and precision."},
          [](const R& r) { return Cell(fmt::format("{}, {}", r.surface, r.precision)); }},
         {{"error", "1", "Largest error of a voxel's force, over the largest force."}, number(&NumberErrors::force)},
         {{"error_shown", "1", "The same, but no less than 1e-17, for logarithmic axes."},
          [](const R& r) { return r.errors.refused.empty() ? cell(std::max(r.errors.force, kLeastShown)) : Cell(); }},
         {{"bound", "1", "The bound that validate holds to, coordinates rounded too; none of meshes."},
          number(&NumberErrors::bound)},
         {{"direction_deg", "deg", "Largest angle between force and true force, where it is not below a thousandth."},
          [](const R& r) { return r.errors.refused.empty() ? cell(r.errors.direction / kDegree) : Cell(); }},
         {{"off_voxels", "1", "Share of the voxels that are off by more than 1e-6 of the largest force."},
          number(&NumberErrors::share_off)},
         {{"step_error", "1",
           "Largest error of the difference of two neighbours along x, over the largest such difference."},
          number(&NumberErrors::step)},
         {{"refused", "", "Why there is no field; empty: there is."},
          [](const R& r) { return Cell(r.errors.refused); }}},
        rows));
    for (const char* axis : {"stiffness", "origin"})
        data.figures.push_back(number_figure(axis_named(axis)));
    Figure steps = number_figure(axis_named("spacing"));
    steps.title = "Error of the difference of neighbours over the spacing of the samples";
    steps.caption =
        "Forces stay good however fine the grid is; what is lost is the difference of two neighbours, as soon "
        "as the spacing comes near the spacing of the numbers themselves, u |x|. At 1 nothing of it is left.";
    steps.y = {"step_error", "error of a difference / largest difference", true};
    data.figures.push_back(std::move(steps));
    data.notes.push_back("Samples over the axes of precision avoid edges, where rounding may choose either facet; the "
                         "worst places are searched for apart, in worst_rounding.");
}

} // namespace forceshade::study
