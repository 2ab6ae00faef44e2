#include "host/study/stability/number.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>

#include "host/reference/surfaces.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::study {
namespace {

constexpr double kPressed = 0.001; /* m: how deep fine grids lie */
constexpr std::uint64_t kColumns = 41, kRows = 9;
constexpr double kShare = 0.2937; /* of a: where fine grids lie; no vertex is near */

/// The parameters of a case.
struct Setting {
    double ratio = 2; /* R / a */
    std::uint32_t facets = 8;
    double stiffness = 1000; /* N/m */
    double origin = 0;       /* m */
    double spacing = 0;      /* m; 0: over the whole bump */
    double depth = 0;        /* m; 0: from the rim down to 2 mm */
};

double& part_of(Setting& setting, const std::string& axis) {
    return axis == "radius_ratio" ? setting.ratio
           : axis == "stiffness"  ? setting.stiffness
           : axis == "origin"     ? setting.origin
           : axis == "spacing"    ? setting.spacing
                                  : setting.depth;
}

// By name, with the shading of its kind.
OwnSurface surface_of(const std::string& surface, const Setting& setting) {
    OwnSurface own;
    own.radius = setting.ratio * kOwnHalfWidth;
    own.facets = setting.facets;
    own.rows = 4;
    own.stiffness = setting.stiffness;
    own.shaded = surface != "bump" && surface != "cylinder bump";
    own.kind = surface == "mesh"                   ? SurfaceKind::mesh
               : surface == "cylinder bump"        ? SurfaceKind::cylinder_bump
               : surface.starts_with("height map") ? SurfaceKind::height_map
                                                   : SurfaceKind::bump;
    own.function = surface == "height map" ? MapFunction::sine : MapFunction::cylinder;
    return own;
}

double circle_height(double ratio, double x) {
    const double radius = ratio * kOwnHalfWidth;
    return (kOwnHalfWidth - x) * (kOwnHalfWidth + x) /
           (reference::circle_rise(radius, x) + reference::circle_rise(radius, kOwnHalfWidth));
}

/// The nominal surface above x, m.
double height_of(const std::string& surface, const Setting& setting, double x) {
    if (surface == "cylinder bump")
        return circle_height(setting.ratio, x);
    if (surface == "mesh") {
        const double cell = 2 * kOwnHalfWidth / setting.facets, left = std::floor(x / cell) * cell;
        return std::lerp(circle_height(setting.ratio, left), circle_height(setting.ratio, left + cell),
                         (x - left) / cell);
    }
    if (!surface.starts_with("bump"))
        return 0;
    const FieldTables<double> tables =
        make_tables<double>(own_case(surface_of(surface, setting)).one.scene, {}, Extent::nothing);
    return reference::facet_at(tables.law(), x).height;
}

struct Box {
    double low[2], high[2]; /* x, z; m */
    std::uint64_t columns = kColumns, rows = kRows;
};

GridSpec grid_of(const Box& box, double y) {
    GridSpec grid;
    grid.size = {box.columns, 1, box.rows};
    grid.origin = {box.low[0], y, box.low[1]};
    const auto step = [](double low, double high, std::uint64_t count) {
        return count > 1 ? (high - low) / static_cast<double>(count - 1) : kOwnHalfWidth;
    };
    grid.spacing = {step(box.low[0], box.high[0], box.columns), kOwnHalfWidth, step(box.low[1], box.high[1], box.rows)};
    return grid;
}

/// The samples of a case, at the origin.
std::vector<Box> boxes_of(const std::string& surface, const Setting& setting) {
    if (setting.depth > 0) {
        std::vector<Box> boxes;
        for (const double share : {-0.8371, -0.4613, kShare, 0.5519, 0.9033}) {
            const double x = share * kOwnHalfWidth, z = height_of(surface, setting, x) - setting.depth;
            boxes.push_back({{x, z}, {x, z}, 1, 1});
        }
        return boxes;
    }
    if (setting.spacing > 0) {
        const double x = kShare * kOwnHalfWidth, z = height_of(surface, setting, x) - kPressed;
        return {{{x, z}, {x + setting.spacing * static_cast<double>(kColumns - 1), z}, kColumns, 1}};
    }
    const double top = surface.starts_with("height map") ? -0.0001 : 0.9 * circle_height(setting.ratio, 0);
    return {{{-0.9131 * kOwnHalfWidth, -0.00193}, {0.8873 * kOwnHalfWidth, top}}};
}

PreparedCase prepared_of(const std::string& surface, const Setting& setting, const Box& box, double away) {
    PreparedCase prepared = own_case(surface_of(surface, setting), glm::dvec3(away));
    prepared.one.scene.output.channels = layout::kChannelForce;
    GridSpec grid = grid_of(box, 0.0371 * kOwnHalfWidth);
    const bool moves = surface == "mesh";
    grid.origin[0] += away;
    grid.origin[1] += moves ? away : 0;
    grid.origin[2] += moves ? away : 0;
    prepared.one.scene.grid = grid;
    return prepared;
}

void add_decades(std::vector<double>& values, int from, int to, int by) {
    for (int decade = from; decade <= to; decade += by)
        values.push_back(std::stod("1e" + std::to_string(decade)));
}

constexpr const char* kAxes[] = {"radius_ratio", "facets", "stiffness", "origin", "spacing", "depth"};

// Of a surface along an axis, ascending; none if the axis does not apply to it.
std::vector<double> number_values(const std::string& surface, const std::string& axis, bool quick) {
    const bool faceted = surface.starts_with("bump"), mesh = surface == "mesh";
    std::vector<double> values;
    if (axis == "radius_ratio" && surface != "height map") {
        values = mesh ? std::vector<double>{1.6} : std::vector<double>{1, 1 + 1e-6, 1.1};
        values.insert(values.end(), {2, 10});
        add_decades(values, 2, 12, quick ? 2 : 1);
    } else if (axis == "facets" && faceted) {
        values = {1, 2, 8, 64};
        add_decades(values, 3, 7, quick ? 2 : 1);
    } else if (axis == "facets" && mesh) {
        values = quick ? std::vector<double>{2, 8, 128} : std::vector<double>{2, 8, 32, 128, 512, 2048};
    } else if (axis == "stiffness") {
        add_decades(values, -45, 45, quick ? 9 : 3);
        values.insert(std::ranges::upper_bound(values, 1000), 3000);
    } else if (axis == "origin" && (mesh || surface == "height map")) {
        values = {0};
        add_decades(values, -3, 6, quick ? 3 : 1);
    } else if (axis == "spacing") {
        add_decades(values, -12, 0, quick ? 2 : 1);
    } else if (axis == "depth") {
        add_decades(values, -12, -2, quick ? 2 : 1);
    }
    return values;
}

constexpr double kLeastShown = 1e-17; /* errors of 0 are shown there */
constexpr double kOriginShown = 1e-4; /* m: where an origin of 0 is shown */

Figure number_figure(const std::string& axis, const char* title, const char* caption, const char* label,
                     const FigureAxis& y) {
    Figure figure = make_figure("number_" + axis, title, caption, FigureKind::scatter, "number", {{"axis", axis}},
                                {"value_shown", label, true}, y, "series");
    figure.joined = true;
    return figure;
}

} // namespace

const std::vector<std::string>& number_surfaces() {
    static const std::vector<std::string> surfaces{"bump",       "shaded bump",          "cylinder bump",
                                                   "height map", "height map, cylinder", "mesh"};
    return surfaces;
}

NumberCase number_case(const std::string& surface, const std::string& axis, double value) {
    Setting setting;
    if (axis == "facets")
        setting.facets = static_cast<std::uint32_t>(value);
    else
        part_of(setting, axis) = value;
    const double away =
        surface == "height map" ? std::round(setting.origin / kOwnWavelength) * kOwnWavelength : setting.origin;
    NumberCase result;
    for (const Box& box : boxes_of(surface, setting)) {
        const PreparedCase home = prepared_of(surface, setting, box, 0);
        result.push_back({away == 0 ? home : prepared_of(surface, setting, box, away), home});
    }
    return result;
}

std::vector<Part> number_parts(Engine& engine, bool quick, std::vector<NumberRow>& rows) {
    std::vector<Part> parts;
    for (const std::string& surface : number_surfaces())
        for (const std::string axis : kAxes) {
            if (number_values(surface, axis, quick).empty())
                continue;
            parts.push_back({fmt::format("numbers: {} over {}", surface, axis), [&engine, &rows, surface, quick, axis] {
                                 const double most_looped =
                                     surface == "mesh" ? 512 : 1e5; /* facets that a referee takes a short time for */
                                 for (const double value : number_values(surface, axis, quick)) {
                                     const NumberCase one = number_case(surface, axis, value);
                                     rows.push_back({surface, axis, value, "f32", single_errors(engine, one)});
                                     if (engine.report().f64 && !(axis == "facets" && value > most_looped))
                                         rows.push_back({surface, axis, value, "f64", double_errors(engine, one)});
                                 }
                             }});
        }
    return parts;
}

void add_numbers(StudyData& data, const std::vector<NumberRow>& rows) {
    using R = NumberRow;
    const auto number = [](double PrecisionErrors::*of) {
        return [of](const R& r) { return r.errors.refused.empty() && r.errors.*of >= 0 ? Cell(r.errors.*of) : Cell(); };
    };
    data.tables.push_back(table_of<R>(
        "number", "Errors of a precision",
        {{"surface", "", "Surface and shading; bump and mesh have 8 facets or cells unless stated.", &R::surface},
         {"axis", "", "The varied parameter; all others are those of the plain scene.", &R::axis},
         {"value", "unit of the axis", "Its value.", &R::value},
         {"value_shown", "unit of the axis", "The value, but 1e-4 for an origin of 0, for logarithmic axes.",
          [](const R& r) { return r.axis == "origin" ? std::max(r.value, kOriginShown) : r.value; }},
         {"precision", "",
          "f32: the engine in single precision against the oracle in double; f64: the engine in double against closed "
          "forms and plain loops in extended precision.",
          &R::precision},
         {"series", "", "Surface and precision.",
          [](const R& r) { return fmt::format("{}, {}", r.surface, r.precision); }},
         {"error", "1", "Largest error of a voxel's force, over the largest force.", number(&PrecisionErrors::force)},
         {"error_shown", "1", "The same, at least 1e-17 for logarithmic axes.",
          [](const R& r) { return r.errors.refused.empty() ? Cell(std::max(r.errors.force, kLeastShown)) : Cell(); }},
         {"bound", "1", "The bound that validate holds to, coordinates rounded too; none of meshes.",
          number(&PrecisionErrors::bound)},
         {"step_error", "1",
          "Largest error of the difference of two neighbours along x, over the largest such difference.",
          number(&PrecisionErrors::step)},
         {"refused", "", "Why the field was refused; empty: it was not.", [](const R& r) { return r.errors.refused; }}},
        rows));
    const char* const largest = "Largest error of a voxel's force over the largest force, away from edges. A point "
                                "that is missing has no force "
                                "in that precision. Errors of 0 are shown at 1e-17.";
    const FigureAxis error{"error_shown", "largest error / largest force", true};
    data.figures.insert(
        data.figures.end(),
        {number_figure("stiffness", "Error of the force over stiffness, with penetrations of millimetres", largest,
                       "stiffness K / (N/m)", error),
         number_figure("origin", "Error of the force over distance of the samples, and of a mesh, from the origin",
                       largest, "distance from the origin / m", error),
         number_figure("spacing", "Error of the difference of neighbours over the spacing of the samples",
                       "Forces stay accurate for every grid; the difference of two neighbours is lost as soon as the "
                       "spacing comes near that of the numbers themselves, u |x|. At 1 it is lost completely.",
                       "spacing of the grid / m", {"step_error", "error of a difference / largest difference", true})});
    data.notes.push_back("Samples over the axes of precision avoid edges, where rounding may choose either facet; the "
                         "worst places are searched separately, in worst_rounding.");
}

} // namespace forceshade::study
