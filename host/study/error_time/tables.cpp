// Orders of convergence, the table of L7, look-ups and precision as tables.
#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host/study/data/rows.h"
#include "host/study/error_time/measured.h"
#include "host/study/error_time/point_table.h"
#include "host/study/run/quartiles.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kRounding = 1e-13;     // errors below it are rounding, and have no order
constexpr std::size_t kFewPlaces = 100; // an error over fewer has no meaning

// The series with those of the look-ups.
std::vector<Series> all_series(const Measured& measured) {
    std::vector<Series> all = measured.series;
    std::map<std::string, std::size_t> known;
    for (const LookupRow& row : measured.lookups) {
        if (row.error.places < kFewPlaces || row.error.rms < kRounding)
            continue;
        const std::string name = fmt::format("look-up of {}: {}, {}", row.surface, row.error.method, row.error.place);
        const auto [at, fresh] = known.try_emplace(name, all.size());
        if (fresh)
            all.push_back({name,
                           "vector RMS, of the RMS force",
                           "spacing / m",
                           {},
                           {},
                           row.expected,
                           row.error.method == "tricubic" && row.error.place == "smooth" ? "Keys 1981" : "laws"});
        all[at->second].sizes.push_back(row.spacing);
        all[at->second].errors.push_back(row.error.rms);
    }
    return all;
}

Table order_table(const std::vector<Series>& all) {
    Table table{"orders",
                "Orders of convergence, observed beside expected",
                {{"series", "", "whose error"},
                 {"quantity", "", "which error"},
                 {"against", "", "the size that it is a power of"},
                 {"order", "1", "observed: slope of the logarithms, least squares"},
                 {"order_deviation", "1", "standard deviation of the slope"},
                 {"expected", "1", "order to be expected, nothing where there is none"},
                 {"expected_from", "", "law or source"},
                 {"difference", "1", "observed less expected"},
                 {"sizes", "1", "how many sizes were fitted"},
                 {"coarsest", "1 or m", "largest size"},
                 {"finest", "1 or m", "smallest size"}},
                {}};
    for (const Series& one : all) {
        const OrderFit fit = fit_order(one.sizes, one.errors);
        if (fit.points < 2)
            continue;
        const auto [finest, coarsest] = std::minmax_element(one.sizes.begin(), one.sizes.end());
        table.rows.push_back(row_of(one.name, one.quantity, one.size, fit.order, fit.deviation, one.expected,
                                    one.expected ? one.from : std::string(),
                                    one.expected ? std::optional(fit.order - *one.expected) : std::nullopt,
                                    double(fit.points), *coarsest, *finest));
    }
    return table;
}

// With a line of the expected slope through the finest point of each series.
Table convergence_table(const std::vector<Series>& all) {
    Table table{
        "convergence",
        "Errors over size",
        {{"series", "", "as in orders"},
         {"group", "",
          "what is shown together: facets by direction or magnitude, cells of patches, cells of meshes, look-ups"},
         {"size", "1 or m", "1 / facets, 1 / cells or spacing"},
         {"error", "deg or 1", "the series' quantity"},
         {"expected_error", "deg or 1", "what the expected order makes of the finest size's error"}},
        {}};
    for (const Series& one : all) {
        const auto finest = std::min_element(one.sizes.begin(), one.sizes.end()) - one.sizes.begin();
        const auto at = static_cast<std::size_t>(finest);
        const std::string group = one.name.starts_with("patch")           ? "patches"
                                  : one.name.starts_with("mesh")          ? "meshes"
                                  : one.name.starts_with("look-up")       ? "look-ups"
                                  : one.quantity.starts_with("direction") ? "facets-direction"
                                                                          : "facets-magnitude";
        for (std::size_t i = 0; i < one.sizes.size(); ++i)
            table.rows.push_back(row_of(
                one.name, group, one.sizes[i], one.errors[i],
                one.expected ? std::optional(one.errors[at] * std::pow(one.sizes[i] / one.sizes[at], *one.expected))
                             : std::nullopt));
    }
    return table;
}

Table interpolation_table(const Measured& measured) {
    Table table{"interpolation",
                "Direction errors of interpolations of vertex normals (L7), beside the printed ones",
                {{"surface", "", "unit cylinder, unit sphere or saddle over [-1/2, 1/2]^2"},
                 {"facets", "", "triangles, quads or hexagons"},
                 {"cells", "1", "along each side"},
                 {"shading", "", "L7"},
                 {"quantity", "", "RMS, largest, or largest jump across an edge"},
                 {"found_deg", "deg", "by this program"},
                 {"printed_deg", "deg", "by the laws, nothing where they print none"},
                 {"deviation_1", "1", "found less printed, of the printed; nothing where 0 is printed"},
                 {"tolerance_1", "1", "that the laws state"},
                 {"agrees", "", "yes or no"}},
                {}};
    constexpr std::array<const char*, 3> kQuantities{"RMS", "largest", "jump"};
    constexpr std::array<double, 3> kTolerance{0.01, 0.03, 0.01};
    constexpr double kNoJump = 1e-7; // deg: rounding
    for (const PatchRow& row : measured.patches)
        for (std::size_t i = 0; i < kQuantities.size(); ++i) {
            std::optional<double> deviation;
            std::string agrees;
            if (row.printed[i] && *row.printed[i] > 0)
                deviation = row.found[i] / *row.printed[i] - 1;
            if (row.printed[i])
                agrees = (deviation ? std::abs(*deviation) <= kTolerance[i] : row.found[i] <= kNoJump) ? "yes" : "no";
            table.rows.push_back(row_of(row.surface, row.cells_of, double(row.cells), row.shading,
                                        std::string(kQuantities[i]), row.found[i], row.printed[i], deviation,
                                        row.printed[i] ? std::optional(kTolerance[i]) : std::nullopt, agrees));
        }
    return table;
}

Table lookup_table(const Measured& measured) {
    Table table{"lookup",
                "Look-up in volumes: errors by where the samples lie",
                {{"surface", "", "what is looked up"},
                 {"method", "", "trilinear or tricubic"},
                 {"place", "", "smooth: all samples on one facet; edge: on several; boundary: not all in contact"},
                 {"series", "", "surface, method and place"},
                 {"spacing_m", "m", "h of the volume"},
                 {"places", "1", "of this kind"},
                 {"error_rms_1", "1", "length of the vector's error, of the root mean square force, RMS"},
                 {"error_max_1", "1", "likewise, the largest"},
                 {"direction_rms_deg", "deg", "angle, RMS"},
                 {"expected_order", "1", "nothing where there is none"}},
                {}};
    for (const LookupRow& row : measured.lookups)
        table.rows.push_back(row_of(
            row.surface, row.error.method, row.error.place, fmt::format("{}, {}", row.error.method, row.error.place),
            row.spacing, double(row.error.places), row.error.places ? std::optional(row.error.rms) : std::nullopt,
            row.error.places ? std::optional(row.error.largest) : std::nullopt,
            row.error.places ? std::optional(row.error.direction_rms) : std::nullopt, row.expected));
    return table;
}

Table precision_table(const Table& points) {
    Table table{"precision",
                "What precision costs: direct evaluation in f32 and with half output, against f64",
                {{"law", "", "surface and law"},
                 {"surface", "", "as in points"},
                 {"elements", "1", "facets of a bump, cells of a mesh"},
                 {"precision", "", "as in points"},
                 {"series", "", "shading and precision"},
                 {"own_time_ratio", "1", "as in points: to f64"},
                 {"reference_vector_rms_1", "1", "as in points: error against f64"},
                 {"reference_vector_max_1", "1", "likewise, the largest"},
                 {"reference_direction_max_deg", "deg", "likewise, the largest angle"}},
                {}};
    for (std::size_t row = 0; row < points.rows.size(); ++row) {
        if (points.word(row, "family") != "direct" || points.word(row, "precision") == "f64")
            continue;
        const auto facets = points.number(row, "facets"), cells = points.number(row, "cells");
        const std::string name = points.word(row, "contender");
        table.rows.push_back(row_of(name.substr(0, name.find(':')), points.word(row, "surface"),
                                    facets ? facets : cells, points.word(row, "precision"),
                                    fmt::format("{}, {}", points.word(row, "shading"), points.word(row, "precision")),
                                    points.number(row, "own_time_ratio"), points.number(row, "reference_vector_rms_1"),
                                    points.number(row, "reference_vector_max_1"),
                                    points.number(row, "reference_direction_max_deg")));
    }
    return table;
}

Table timing_table(const Measured& measured) {
    Table table{"timing",
                "How times were taken",
                {{"unit", "", "the contender whose reference<double> is the unit of time_ratio"},
                 {"rounds", "1", "each measures every contender once, in an order of its own"},
                 {"unit_ns", "ns", "an evaluation of the unit, median over the rounds"},
                 {"unit_low_ns", "ns", "its lower quartile"},
                 {"unit_high_ns", "ns", "its upper quartile"}},
                {}};
    std::vector<double> units;
    for (const Round& round : measured.rounds)
        units.push_back(round.unit * 1e9);
    if (units.empty())
        return table;
    const Quartiles unit = quartiles(units);
    table.rows.push_back(
        row_of(measured.contenders[measured.unit].name, double(units.size()), unit.median, unit.low, unit.high));
    return table;
}

} // namespace

std::vector<Table> tables_of(const Measured& measured) {
    const std::vector<Series> all = all_series(measured);
    const Table points = point_table(measured);
    std::vector<Table> tables{points, front_table(points), cheapest_table(points), order_table(all),
                              convergence_table(all)};
    if (!measured.patches.empty())
        tables.push_back(interpolation_table(measured));
    if (!measured.lookups.empty())
        tables.push_back(lookup_table(measured));
    tables.push_back(precision_table(points));
    tables.push_back(timing_table(measured));
    return tables;
}

} // namespace forceshade::study::error_time
