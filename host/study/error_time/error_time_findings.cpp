#include "host/study/error_time/error_time_findings.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "host/study/error_time/error_time_points.h"
#include "host/study/error_time/error_time_ways.h"

namespace forceshade::study {
namespace {

using Rows = std::vector<std::size_t>;

// Rows whose columns hold these words.
Rows rows_where(const Table& table, const Where& where) {
    Rows rows;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (std::ranges::all_of(where, [&](const auto& one) { return table.word(row, one.first) == one.second; }))
            rows.push_back(row);
    return rows;
}

std::vector<std::string> words_of(const Table& table, std::string_view column) {
    std::vector<std::string> words;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (std::ranges::find(words, table.word(row, column)) == words.end())
            words.push_back(table.word(row, column));
    return words;
}

std::string after_surface(const std::string& contender) {
    const std::size_t at = contender.find(", ");
    return at == std::string::npos ? contender : contender.substr(at + 2);
}

std::string bounded(double bound, const std::string& unit) {
    return unit == "deg" ? fmt::format("{:g}°", bound) : fmt::format("{:g} %", 100 * bound);
}

// "flat, 64 facets: direct f32 (0.92 times the unit, 0.51°)"
std::string cheapest_text(const Table& table, std::size_t row) {
    const std::string unit = table.word(row, "bound_unit");
    if (table.word(row, "contender").empty())
        return "nothing that was tried";
    return fmt::format("\"{}\" ({:.2g} times the unit, {})", after_surface(table.word(row, "contender")),
                       table.number(row, "time_ratio").value_or(NAN),
                       unit == "deg" ? fmt::format("{:.2g}°", table.number(row, "error").value_or(NAN))
                                     : fmt::format("{:.2g} %", 100 * table.number(row, "error").value_or(NAN)));
}

// What times are told in.
std::string unit_text(const StudyData& data) {
    const Table& timing = data.table("timing");
    if (timing.rows.empty())
        return "";
    return fmt::format("; times are in units of {:.2g} ns, an evaluation of \"{}\" on one thread of this machine",
                       timing.number(0, "unit_ns").value_or(NAN), timing.word(0, "unit"));
}

std::optional<std::size_t> cheapest_row(const Table& table, const std::string& surface, const std::string& use,
                                        const std::string& criterion, double bound) {
    for (const std::size_t row : rows_where(table, {{"surface", surface}, {"use", use}, {"criterion", criterion}}))
        if (table.number(row, "bound") == bound)
            return row;
    return std::nullopt;
}

void add_cheapest(std::vector<Finding>& findings, const StudyData& data) {
    const Table& table = data.table("cheapest");
    for (const std::string& surface : words_of(table, "surface"))
        for (const auto& [bound, within, name] : {std::tuple(1.0, 0.05, "1deg"), std::tuple(0.1, 0.01, "01deg")}) {
            const auto angle = cheapest_row(table, surface, "live", "direction RMS", bound);
            const auto vector = cheapest_row(table, surface, "live", "vector RMS", within);
            const auto volume = cheapest_row(table, surface, "volume", "direction RMS", bound);
            if (!angle || !vector)
                continue;
            std::string text = fmt::format(
                "{}, for a direction error of at most {} RMS the cheapest is {}; for the whole force within {} RMS {} "
                "{}",
                on_surface(surface), bounded(bound, "deg"), cheapest_text(table, *angle), bounded(within, "1"),
                table.word(*angle, "contender") == table.word(*vector, "contender") ? "it is also" : "it is",
                cheapest_text(table, *vector));
            if (volume && !table.word(*volume, "contender").empty())
                text +=
                    fmt::format("; over whole grids, for the same direction error, {}", cheapest_text(table, *volume));
            if (findings.empty())
                text += unit_text(data);
            findings.push_back({fmt::format("cheapest_{}_{}", name, surface), text + "."});
        }
}

// How many facets a flat and a shaded bump need for a degree.
void add_facets(std::vector<Finding>& findings, const StudyData& data) {
    const Table& points = data.table("points");
    const auto fewest = [&](const std::string& shading) {
        std::optional<std::size_t> best;
        for (const std::size_t row :
             rows_where(points, {{"family", "direct"}, {"precision", "f64"}, {"shading", shading}})) {
            const auto facets = points.number(row, "facets");
            const bool touches =
                points.number(row, "contact_differs").value_or(0) <= 0.01 * points.number(row, "places").value_or(0);
            if (facets && touches && has_smooth_shape(points, row) &&
                points.number(row, "direction_rms_deg").value_or(INFINITY) <= 1 &&
                (!best || *facets < points.number(*best, "facets")))
                best = row;
        }
        return best;
    };
    const auto flat = fewest("none"), shaded = fewest("reference");
    if (!shaded)
        return;
    const double n = points.needed(*shaded, "facets");
    const std::string without =
        flat ? fmt::format("of the numbers tried, flat ones need {:g} ({:.2g}°)", points.needed(*flat, "facets"),
                           points.needed(*flat, "direction_rms_deg"))
             : std::string("no number of flat ones that was tried does");
    findings.push_back(
        {"facets_1deg",
         fmt::format("For a direction within 1° RMS a bump needs {:g} shaded facet{}; {}. The magnitude "
                     "is then off by {:.2g} % with shading.",
                     n, n == 1 ? "" : "s", without, 100 * points.number(*shaded, "magnitude_rms_1").value_or(NAN))});
}

void add_orders(std::vector<Finding>& findings, const StudyData& data) {
    constexpr double kNear = 0.15;
    const Table& orders = data.table("orders");
    std::size_t expected = 0, near = 0, worst = 0;
    double furthest = -1;
    for (std::size_t row = 0; row < orders.rows.size(); ++row) {
        const auto difference = orders.number(row, "difference");
        if (!difference)
            continue;
        ++expected;
        near += std::abs(*difference) <= kNear ? 1 : 0;
        if (std::abs(*difference) > furthest) {
            furthest = std::abs(*difference);
            worst = row;
        }
    }
    if (expected == 0)
        return;
    findings.push_back(
        {"orders",
         fmt::format(
             "{} of {} observed orders of convergence are within {} of those to be expected; the furthest is that of "
             "\"{}\": {:.2f} where {:g} is expected.",
             near, expected, kNear, orders.word(worst, "series"), orders.needed(worst, "order"),
             orders.needed(worst, "expected"))});
}

std::optional<double> order_of(const Table& orders, const std::string& series) {
    for (const std::size_t row : rows_where(orders, {{"series", series}}))
        return orders.number(row, "order");
    return std::nullopt;
}

void add_depth(std::vector<Finding>& findings, const StudyData& data) {
    const Table& orders = data.table("orders");
    const auto surface = order_of(orders, "patch of triangles, mean_value");
    const auto depth = order_of(orders, "mesh, mean_value, static");
    if (!surface || !depth)
        return;
    findings.push_back(
        {"order_at_depth",
         fmt::format("The direction error of mean_value falls with order {:.2f} of the cell size on the surface, {} "
                     "order {:.2f} for a probe that presses in.",
                     *surface, *depth < *surface - 0.5 ? "but only with" : "and with", *depth)});
}

void add_interpolation(std::vector<Finding>& findings, const StudyData& data) {
    const Table* table = data.find("interpolation");
    if (!table)
        return;
    const std::size_t agree = rows_where(*table, {{"agrees", "yes"}}).size();
    const Rows differ = rows_where(*table, {{"agrees", "no"}});
    if (differ.empty()) {
        findings.push_back(
            {"interpolation",
             fmt::format(
                 "The table of interpolations of the laws is reproduced: all {} printed values agree, root mean "
                 "squares and jumps within 1 %, maxima within 3 %.",
                 agree)});
        return;
    }
    const std::size_t row = differ.front();
    findings.push_back(
        {"interpolation",
         fmt::format(
             "{} of {} printed values of the laws' table of interpolations are not reproduced, the first: {} of {} "
             "on {} {} {}, {:.3g}° where {:.3g}° is printed.",
             differ.size(), agree + differ.size(), table->word(row, "quantity"), table->word(row, "shading"),
             table->word(row, "surface"), table->word(row, "facets"), table->number(row, "cells").value_or(NAN),
             table->number(row, "found_deg").value_or(NAN), table->number(row, "printed_deg").value_or(NAN))});
}

// The coarsest spacing at which a trilinear reading is within a bound wherever its samples lie.
void add_spacing(std::vector<Finding>& findings, const StudyData& data) {
    constexpr double kWithin = 0.01;
    const Table* table = data.find("lookup");
    if (!table)
        return;
    std::size_t number = 0;
    for (const std::string& surface : words_of(*table, "surface")) {
        std::map<double, std::pair<double, std::string>> worst; // by spacing: error, place
        for (const std::size_t row : rows_where(*table, {{"surface", surface}, {"method", "trilinear"}})) {
            const auto spacing = table->number(row, "spacing_m"), error = table->number(row, "error_rms_1");
            if (spacing && error && *error > worst[*spacing].first)
                worst[*spacing] = {*error, table->word(row, "place")};
        }
        if (worst.empty())
            continue;
        const auto text = [&](auto one, const char* sentence) {
            const auto& [spacing, error] = *one;
            const char* const where = error.second == "edge"       ? "across edges"
                                      : error.second == "boundary" ? "at the boundary of contact"
                                                                   : "between edges";
            return fmt::format(fmt::runtime(sentence), surface, spacing * 1e3, 100 * error.first, where);
        };
        const auto fails = std::ranges::find_if(worst, [&](const auto& one) { return one.second.first > kWithin; });
        findings.push_back({fmt::format("lookup_spacing_{}", ++number),
                            fails == worst.begin()
                                ? text(fails, "No trilinear volume of the {} that was tried is within 1 % RMS "
                                              "everywhere: at {:g} mm it is {:.2g} % off {}.")
                                : text(std::prev(fails), "A trilinear volume of the {} is within 1 % RMS "
                                                         "everywhere at spacings up to {:g} mm ({:.2g} %, {}).")});
    }
}

} // namespace

std::vector<Finding> error_time_findings(const StudyData& data) {
    std::vector<Finding> findings;
    add_cheapest(findings, data);
    add_facets(findings, data);
    add_ways(findings, data);
    add_spacing(findings, data);
    add_orders(findings, data);
    add_depth(findings, data);
    add_interpolation(findings, data);
    return findings;
}

} // namespace forceshade::study
