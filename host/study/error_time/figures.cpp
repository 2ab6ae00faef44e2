// Pictures of error over time, convergence, look-ups and precision.
#include <algorithm>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/error_time/measured.h"

namespace forceshade::study::error_time {
namespace {

const Table& named(const std::vector<Table>& tables, const std::string& name) {
    return *std::find_if(tables.begin(), tables.end(), [&](const Table& one) { return one.name == name; });
}

bool has(const std::vector<Table>& tables, const std::string& name) {
    return std::any_of(tables.begin(), tables.end(), [&](const Table& one) { return one.name == name; });
}

std::vector<std::string> words_of(const Table& table, const std::string& column) {
    std::vector<std::string> words;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (std::find(words.begin(), words.end(), table.word(row, column)) == words.end())
            words.push_back(table.word(row, column));
    return words;
}

// "Look-ups are of volumes of 16 x 16 cells, mean_value and of 64 x 64 cells, mean_value."; nothing of none.
std::string volumes_text(const Table& points, const std::string& surface) {
    std::vector<std::string> laws;
    for (std::size_t row = 0; row < points.rows.size(); ++row) {
        if (points.word(row, "surface") != surface || !points.word(row, "family").starts_with("look-up"))
            continue;
        const std::string name = points.word(row, "contender");
        const std::size_t from = name.find(", ") + 2;
        const std::string law = name.substr(from, name.find(':') - from);
        if (std::find(laws.begin(), laws.end(), law) == laws.end())
            laws.push_back(law);
    }
    return laws.empty() ? "" : fmt::format(" Look-ups are of volumes of {}.", fmt::join(laws, " and of "));
}

// What the errors of a surface are against.
std::string against(const Table& points, const std::string& surface) {
    for (std::size_t row = 0; row < points.rows.size(); ++row)
        if (points.word(row, "surface") == surface)
            return points.word(row, "against");
    return "";
}

// Error over time of a surface, with the fronts as curves.
Figure scatter(const Table& points, const std::string& surface, bool vector) {
    Figure figure;
    const std::string criterion = vector ? "vector" : "direction", other = against(points, surface);
    const std::string off = other == kSmoothShape ? "" : " off " + other;
    figure.name = fmt::format("error-time-{}-{}", surface, criterion);
    figure.title =
        fmt::format("{}: error of the force{}{} against run time", surface, vector ? "" : "'s direction", off);
    figure.caption =
        fmt::format("Each mark is a way of coming by a force; left is cheaper, down is closer to {}. The "
                    "lines join what nothing "
                    "beats: one for live use, one for whole grids. Errors below {} stand at that.{}{}",
                    other, vector ? "1e-9" : "1e-7 deg", volumes_text(points, surface),
                    vector ? " Here the error is of the whole vector, of which direction is a part."
                           : " A direction may be right where the magnitude is not: see the picture of vectors.");
    figure.table = "points";
    figure.where = {{"surface", surface}};
    figure.x = {"time_ratio", "time of an evaluation / time in double on one CPU thread", true};
    figure.y = vector ? FigureAxis{"shown_vector_1", fmt::format("RMS relative error of the force vector{}", off), true}
                      : FigureAxis{"shown_direction_deg", fmt::format("RMS direction error{} / deg", off), true};
    figure.series = "family";
    figure.label = criterion + "_label";
    for (const char* use : {"live", "volume"})
        figure.curves.push_back({"front",
                                 {{"surface", surface}, {"use", use}, {"criterion", criterion}},
                                 "time_ratio",
                                 "shown_error",
                                 fmt::format("front, {}", use == std::string("live") ? "live" : "whole grids"),
                                 use != std::string("live")});
    return figure;
}

// A dashed line of the expected order for each series of table convergence that `shown(row)` admits.
template <typename Shown> void add_expected(Figure& figure, const Table& table, const Shown& shown) {
    std::vector<std::string> drawn;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const std::string series = table.word(row, "series");
        if (!shown(row) || !table.number(row, "expected_error") ||
            std::find(drawn.begin(), drawn.end(), series) != drawn.end())
            continue;
        drawn.push_back(series);
        figure.curves.push_back({"convergence", {{"series", series}}, "size", "expected_error", "expected", true});
    }
}

Figure convergence(const Table& table, const std::string& group, const std::string& title, const FigureAxis& x,
                   const FigureAxis& y) {
    Figure figure;
    figure.name = "convergence-" + group;
    figure.title = title;
    figure.caption = "Marks are measured errors; dashed lines have the order to be expected and go through the finest "
                     "size. Where marks and line "
                     "run alike, the order is observed; table orders has the slopes.";
    figure.table = "convergence";
    figure.where = {{"group", group}};
    figure.x = x;
    figure.y = y;
    figure.series = "series";
    figure.joined = true;
    add_expected(figure, table, [&](std::size_t row) { return table.word(row, "group") == group; });
    return figure;
}

// `sizes` has the lines of the orders to be expected.
Figure lookup(const Table& sizes, const std::string& surface, std::size_t number) {
    Figure figure;
    figure.name = fmt::format("lookup-{}", number);
    figure.title = fmt::format("Look-up of the {}: error over the volume's spacing", surface);
    figure.caption =
        "Smooth: all samples that a reading takes lie on one facet; edge: on several; boundary: not all are in "
        "contact. In smooth "
        "parts a finer volume pays off by the square or more, across edges only in proportion, and across a "
        "jump of the direction not at all. Dashed lines have the orders to be expected.";
    figure.table = "lookup";
    figure.where = {{"surface", surface}};
    figure.x = {"spacing_m", "spacing h / m", true};
    figure.y = {"error_rms_1", "RMS error of the force, of the RMS force", true};
    figure.series = "series";
    figure.joined = true;
    add_expected(figure, sizes, [&](std::size_t row) {
        return sizes.word(row, "series").starts_with(fmt::format("look-up of {}:", surface));
    });
    return figure;
}

// How many numbers of facets or cells a surface has in the table of precision.
std::size_t sizes_of(const Table& table, const std::string& surface) {
    std::set<double> sizes;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (const auto size = table.number(row, "elements"); size && table.word(row, "surface") == surface)
            sizes.insert(*size);
    return sizes.size();
}

// Over facets or cells, of a surface that has some numbers of these.
Figure precision(const std::string& surface) {
    Figure figure;
    figure.name = "precision-" + surface;
    figure.title = fmt::format("{}: error of single precision and of half output against double", surface);
    figure.caption =
        "Relative error of the force vector against the same law in double, root mean square over the places. Single "
        "precision keeps seven digits, half output three and a half; an error far above that is from places that "
        "rounding puts on a neighbouring facet whose force differs.";
    figure.table = "precision";
    figure.where = {{"surface", surface}};
    figure.x = {"elements", surface == "mesh" ? "cells along a side" : "facets", true};
    figure.y = {"reference_vector_rms_1", "RMS relative error against f64", true};
    figure.series = "series";
    figure.joined = true;
    return figure;
}

} // namespace

std::vector<Figure> figures_of(const std::vector<Table>& tables) {
    std::vector<Figure> figures;
    const Table& points = named(tables, "points");
    for (const std::string& surface : words_of(points, "surface"))
        for (const bool vector : {false, true})
            figures.push_back(scatter(points, surface, vector));
    const Table& sizes = named(tables, "convergence");
    const std::vector<std::string> groups = words_of(sizes, "group");
    const auto add = [&](const std::string& group, const std::string& title, const FigureAxis& x, const FigureAxis& y) {
        if (std::find(groups.begin(), groups.end(), group) != groups.end())
            figures.push_back(convergence(sizes, group, title, x, y));
    };
    add("facets-direction", "Bump: direction error over the number of facets", {"size", "1 / facets", true},
        {"error", "RMS direction error / deg", true});
    add("facets-magnitude", "Bump: magnitude error over the number of facets", {"size", "1 / facets", true},
        {"error", "RMS relative error of the magnitude", true});
    add("patches", "Patches of triangles: direction error over the cell size", {"size", "1 / cells", true},
        {"error", "RMS direction error / deg", true});
    add("meshes", "Meshes of the cylinder: direction error over the cell size", {"size", "1 / cells", true},
        {"error", "RMS direction error / deg", true});
    if (has(tables, "lookup")) {
        std::size_t number = 0;
        for (const std::string& surface : words_of(named(tables, "lookup"), "surface"))
            figures.push_back(lookup(sizes, surface, ++number));
    }
    const Table& precisions = named(tables, "precision");
    for (const std::string& surface : words_of(precisions, "surface"))
        if (sizes_of(precisions, surface) > 1)
            figures.push_back(precision(surface));
    return figures;
}

} // namespace forceshade::study::error_time
