// Errors of precision, parameter by parameter; and the worst of single precision, law by law.
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>

#include <fmt/format.h>
#include <glm/vec2.hpp>

#include "host/numbers.h"
#include "host/random.h"
#include "host/reference/surfaces.h"
#include "host/study/stability/stability.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::study {
namespace {

constexpr double kPressed = 0.001; /* m: how deep fine grids lie */
constexpr std::uint64_t kColumns = 41, kRows = 9;
constexpr double kShare = 0.2937; /* of a: where fine grids lie; no vertex is near */

/// The parameters of a case.
struct Setting : OwnSurface {
    double origin = 0;  /* m */
    double spacing = 0; /* m; 0: over the whole bump */
    double depth = 0;   /* m; 0: from the rim down to 2 mm */

    bool is_mesh() const { return kind == SurfaceKind::mesh; }
    bool is_map() const { return kind == SurfaceKind::height_map; }
    bool is_wave() const { return is_map() && function == MapFunction::sine; }
    bool is_plain_bump() const { return kind == SurfaceKind::bump && !shaded; }
};

Setting plain_setting(const std::string& surface) {
    return {studied_surface(surface).own};
}

double circle_height(double radius, double x) {
    return reference::cylinder_height(kOwnHalfWidth, radius, x);
}

/// The nominal surface above x, m.
double height_of(const Setting& setting, double x) {
    if (setting.kind == SurfaceKind::cylinder_bump)
        return circle_height(setting.radius, x);
    if (setting.is_map())
        return 0;
    const OwnSurface facets{.radius = setting.radius, .facets = setting.facets}; // those of a mesh's cells, too
    const FieldTables<double> tables = make_tables<double>(own_case(facets).one.scene, {}, Extent::nothing);
    return reference::facet_at(tables.law(), x).height;
}

/// Samples of a section from (x, z) `low` to `high`, m.
GridSpec grid_between(const glm::dvec2& low, const glm::dvec2& high, std::uint64_t columns, std::uint64_t rows) {
    const auto step = [](double from, double to, std::uint64_t count) {
        return count > 1 ? (to - from) / static_cast<double>(count - 1) : kOwnHalfWidth;
    };
    GridSpec grid;
    grid.size = {columns, 1, rows};
    grid.origin = {low.x, 0.0371 * kOwnHalfWidth, low.y};
    grid.spacing = {step(low.x, high.x, columns), kOwnHalfWidth, step(low.y, high.y, rows)};
    return grid;
}

/// The samples of a case, at the origin; of a draw from 1 on moved at random, fine ones without reaching a vertex.
std::vector<GridSpec> grids_of(const Setting& setting, std::uint64_t draw) {
    std::vector<GridSpec> grids;
    Random random(draw, "grids of the study of numbers");
    const double moved = draw == 0 ? 0 : random(-1, 1);
    const double aside = 0.02 * moved * kOwnHalfWidth; // m
    const auto below = [&](double x, double depth) { return glm::dvec2(x, height_of(setting, x) - depth); };
    if (setting.depth > 0) {
        for (const double share : {-0.8371, -0.4613, kShare, 0.5519, 0.9033}) {
            const glm::dvec2 at = below(share * kOwnHalfWidth + aside, setting.depth);
            grids.push_back(grid_between(at, at, 1, 1));
        }
    } else if (setting.spacing > 0) {
        const glm::dvec2 at = below(kShare * kOwnHalfWidth + aside, kPressed);
        const double width = setting.spacing * static_cast<double>(kColumns - 1);
        grids.push_back(grid_between(at, {at.x + width, at.y}, kColumns, 1));
    } else {
        const double top = setting.is_map() ? -0.0001 : 0.9 * circle_height(setting.radius, 0);
        GridSpec& grid = grids.emplace_back(
            grid_between({-0.9131 * kOwnHalfWidth, -0.00193}, {0.8873 * kOwnHalfWidth, top}, kColumns, kRows));
        grid.origin[0] += 0.5 * moved * grid.spacing[0];
        grid.origin[2] -= draw == 0 ? 0 : random(0, 0.5) * grid.spacing[2];
    }
    return grids;
}

PreparedCase prepared_of(const Setting& setting, GridSpec grid, double away) {
    PreparedCase prepared = own_case(setting, glm::dvec3(away));
    prepared.one.scene.output.channels = layout::kChannelForce;
    grid.origin[0] += away;
    grid.origin[1] += setting.is_mesh() ? away : 0;
    grid.origin[2] += setting.is_mesh() ? away : 0;
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
    const Setting setting = plain_setting(surface);
    const bool mesh = setting.is_mesh();
    std::vector<double> values;
    if (axis == "radius_ratio" && !setting.is_wave()) {
        values = mesh ? std::vector<double>{1.6} : std::vector<double>{1, 1 + 1e-6, 1.1};
        values.insert(values.end(), {2, 10});
        add_decades(values, 2, 12, quick ? 2 : 1);
    } else if (axis == "facets" && setting.is_plain_bump()) {
        values = {1, 2, 8, 64};
        add_decades(values, 3, 7, quick ? 2 : 1);
    } else if (axis == "facets" && mesh) {
        values = quick ? std::vector<double>{2, 8, 128} : std::vector<double>{2, 8, 32, 128, 512, 2048};
    } else if (axis == "stiffness") {
        add_decades(values, -45, 45, quick ? 9 : 3);
        values.insert(std::ranges::upper_bound(values, 1000), 3000);
    } else if (axis == "origin" && (mesh || setting.is_wave())) {
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
    return make_figure("number_" + axis, title, caption, FigureKind::scatter, "number", {{"axis", axis}},
                       {"value_shown", label, true}, y, "series", "", {.joined = true});
}

} // namespace

std::vector<std::string> number_surfaces() {
    std::vector<std::string> names;
    for (const StudiedSurface& one : studied_surfaces(kNumbers))
        names.push_back(one.name);
    return names;
}

NumberCase number_case(const std::string& surface, const std::string& axis, double value, std::uint64_t draw) {
    Setting setting = plain_setting(surface);
    if (axis == "facets")
        setting.facets = static_cast<std::uint32_t>(value);
    else if (axis == "radius_ratio")
        setting.radius = value * kOwnHalfWidth;
    else
        (axis == "stiffness" ? setting.stiffness
         : axis == "origin"  ? setting.origin
         : axis == "spacing" ? setting.spacing
                             : setting.depth) = value;
    const double away =
        setting.is_wave() ? std::round(setting.origin / kOwnWavelength) * kOwnWavelength : setting.origin;
    NumberCase result;
    for (const GridSpec& grid : grids_of(setting, draw)) {
        const PreparedCase home = prepared_of(setting, grid, 0);
        result.push_back({away == 0 ? home : prepared_of(setting, grid, away), home});
    }
    return result;
}

namespace {

// The worst of all draws of a grid, and the least of their errors.
NumberRow row_of(NumberRow row, const std::vector<PrecisionErrors>& draws) {
    for (const PrecisionErrors& one : draws) {
        row.errors.force = std::fmax(row.errors.force, one.force);
        row.errors.step = std::fmax(row.errors.step, one.step);
        row.errors.bound = std::fmax(row.errors.bound, one.bound);
        row.least = std::fmin(row.least, one.force);
        if (!one.refused.empty())
            row.errors.refused = one.refused;
    }
    return row;
}

} // namespace

std::vector<Part> number_parts(Engine& engine, bool quick, std::deque<std::vector<NumberRow>>& found) {
    std::vector<Part> parts;
    for (const std::string& surface : number_surfaces())
        for (const std::string axis : kAxes) {
            if (number_values(surface, axis, quick).empty())
                continue;
            parts.push_back(
                {fmt::format("numbers: {} over {}", surface, axis),
                 [&engine, &rows = found.emplace_back(), surface, quick, axis] {
                     const double most_looped = plain_setting(surface).is_mesh()
                                                    ? 512
                                                    : 1e5; /* facets that a referee takes a short time for */
                     for (const double value : number_values(surface, axis, quick)) {
                         const auto over_draws = [&](const auto& errors_of) {
                             std::vector<PrecisionErrors> draws;
                             for (std::uint64_t draw = 0; draw < (quick ? 2 : 4); ++draw)
                                 draws.push_back(errors_of(number_case(surface, axis, value, draw)));
                             return draws;
                         };
                         rows.push_back(row_of({surface, axis, value, "f32"}, over_draws([&](const auto& one) {
                                                   return single_errors(engine, one);
                                               })));
                         if (engine.report().f64 && !(axis == "facets" && value > most_looped))
                             rows.push_back(row_of({surface, axis, value, "f64"}, over_draws([&](const auto& one) {
                                                       return double_errors(engine, one);
                                                   })));
                     }
                 },
                 true});
        }
    return parts;
}

void add_numbers(StudyData& data, const std::vector<NumberRow>& rows) {
    using R = NumberRow;
    const auto number = [](double PrecisionErrors::*of) { return [of](const R& r) { return r.errors.*of; }; };
    data.tables.push_back(table_of<R>(
        "number", "Errors of a precision",
        {{"surface", "", "which; bump and mesh have 8 facets or cells unless stated", &R::surface},
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
         {"error", "1",
          "Largest error of a voxel's force, over the largest force: of a grid and others moved at random.",
          number(&PrecisionErrors::force)},
         {"error_least", "1", "The least of the grids' errors.", &R::least},
         {"error_shown", "1", "The same, at least 1e-17 for logarithmic axes.",
          [](const R& r) { return r.errors.force < kLeastShown ? kLeastShown : r.errors.force; }},
         {"bound", "1", "The bound that validate holds to, coordinates rounded too; none of meshes.",
          number(&PrecisionErrors::bound)},
         {"step_error", "1",
          "Largest error of the difference of two neighbours along x, over the largest such difference.",
          number(&PrecisionErrors::step)},
         {"refused", "", "Why the field was refused; empty: it was not.", [](const R& r) { return r.errors.refused; }}},
        rows));
    const char* const largest = "Largest error of a voxel's force over the largest force, away from edges. A point "
                                "that is missing has no force in that precision. Errors of 0 are shown at 1e-17.";
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

// The worst that a search finds.
namespace {

struct SearchedLaw {
    std::string name;
    PreparedCase prepared;
    bool strokes = false; /* of the god-object */
    bool rare = false;    /* its worst place takes many places to find */
};

std::vector<SearchedLaw> own_laws() {
    constexpr std::uint64_t kSide = 64;
    std::vector<SearchedLaw> laws;
    for (const StudiedSurface& one : studied_surfaces(kRounding)) {
        PreparedCase prepared = own_case(one.own);
        const bool mesh = one.own.kind == SurfaceKind::mesh, thin = mesh && one.own.rows > kMeshCells;
        prepared.one.scene.field = !mesh; // of a mesh all of the block, its walls too
        prepared.one.scene.grid = grid_over(one.box, {kSide, kSide, kSide});
        laws.push_back({one.name, prepared, false, thin && one.own.shading == Shading::two_pass});
        if (mesh && !thin)
            laws.push_back({fmt::format("{}, god-object", one.name), prepared, true});
    }
    return laws;
}

// In single precision, whatever it asks for.
std::vector<SearchedLaw> laws_of(PreparedCase scene) {
    scene.one.scene.precision = Precision::f32;
    std::vector<SearchedLaw> laws{{"this scene", scene}};
    if (scene.images.mesh)
        laws.push_back({"this scene, god-object", scene, true});
    return laws;
}

} // namespace

std::vector<Part> worst_rounding_parts(const PreparedCase* scene, bool quick,
                                       std::deque<std::vector<LawRounding>>& found) {
    std::vector<Part> parts;
    for (const SearchedLaw& law : scene ? laws_of(*scene) : own_laws())
        parts.push_back({"single precision of " + law.name,
                         [law, quick, &rows = found.emplace_back()] {
                             const std::size_t places = quick && !law.rare ? 20'000 : 200'000;
                             for (const WorstRounding& one :
                                  worst_rounding(law.prepared, law.strokes ? places / 20 : places, law.strokes))
                                 rows.push_back({one, law.name});
                         },
                         true});
    return parts;
}

void add_worst_rounding(StudyData& data, const std::vector<LawRounding>& found, bool own) {
    using R = LawRounding;
    const auto coordinate = [](int axis) { return [axis](const R& r) { return 1e3 * r.place[axis]; }; };
    data.tables.push_back(table_of<R>(
        "worst_rounding", "Largest errors of single precision that a search found, 0.02 to 2 mm deep",
        {{"law", "",
          fmt::format("{}god-object: at the end of a straight stroke from the open",
                      own ? "a surface of the studies' list, K = 1000 N/m; " : "the scene's, static; "),
          &R::law},
         {"facet", "",
          "same: both precisions meet the same facet, away from edges of the law; another: rounding chose between "
          "facets that are equally near, or sides of an edge",
          [](const R& r) { return r.same_facet ? "same facet" : "another facet"; }},
         {"error_1", "1", "difference of the forces over the largest force of the search, that at 2 mm", &R::error},
         {"local_1", "1", "over the force there", &R::local},
         {"turn_deg", "deg", "angle between both forces", &R::turn},
         {"gradient_1", "1",
          "most that the law in double changes by within the rounding of single precision, over K times the way: how "
          "ill-conditioned the force is there",
          &R::gradient},
         {"depth_mm", "mm", "of the place", [](const R& r) { return 1e3 * r.depth; }},
         {"x_mm", "mm", "of the place", coordinate(0)},
         {"y_mm", "mm", "of the place", coordinate(1)},
         {"z_mm", "mm", "of the place", coordinate(2)},
         {"evaluations", "1",
          "of the law in each precision, aimed at facets, edges, corners and ties and climbing from the worst",
          &R::evaluations}},
        found));
    const auto worst = [&](bool strokes, bool same) {
        const LawRounding* most = nullptr;
        for (const LawRounding& one : found)
            if (one.from.has_value() == strokes && one.same_facet == same && (!most || one.error > most->error))
                most = &one;
        return most;
    };
    const LawRounding *same = worst(false, true), *other = worst(false, false);
    if (!same)
        return;
    std::size_t evaluations = 0;
    for (const LawRounding& one : found)
        evaluations += one.same_facet ? one.evaluations : 0;
    std::string text = fmt::format("Single precision of a field differs from double by up to {:.2g} of the largest "
                                   "force where both meet the same facet",
                                   same->error);
    if (other)
        text += fmt::format(", and by up to {} times that force where two facets are equally near and rounding "
                            "chooses: the static field jumps there whatever the shading",
                            numbers::number_text(other->error, 2));
    std::string laws = same->law + (other ? "; " + other->law : std::string());
    if (const LawRounding* stroke = worst(true, true)) {
        text += fmt::format(". A god-object's differs by up to {:.2g} of it at the ends of strokes", stroke->error);
        laws += "; " + stroke->law;
    }
    if (const LawRounding* fork = worst(true, false)) {
        text +=
            fmt::format(", and by up to {:.2g} times it where two strokes fork at an edge. It does not jump between "
                        "facets that are equally near, but further on, where its proxy slides over the ridge",
                        fork->error);
        laws += "; " + fork->law;
    }
    data.figures.push_back(
        make_figure("worst-rounding", "Largest error of single precision that a search found, law by law",
                    "Largest difference of the forces that a search found, over the largest force. Where rounding "
                    "chooses another facet of a tie, a law whose direction jumps from facet to facet jumps with it.",
                    FigureKind::bars, "worst_rounding", {}, {"law", "law"},
                    {"error_1", "difference of the forces / largest force", true}, "facet"));
    data.findings.push_back({"worst_rounding", text + ".", "worst-rounding", laws,
                             own ? "probe 0.02 to 2 mm deep" : "as deep as a hand goes",
                             fmt::format("the worst of {} evaluations of {} laws: a search, not a bound", evaluations,
                                         std::ranges::count(found, true, &LawRounding::same_facet))});
}

} // namespace forceshade::study
