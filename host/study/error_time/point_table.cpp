// Every contender: what it costs and how far off it is; the Pareto fronts, and the cheapest within a bound.
#include "host/study/error_time/point_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host/study/data/rows.h"
#include "host/study/run/quartiles.h"

namespace forceshade::study::error_time {
namespace {

constexpr double kMostMissed = 0.01;       // of the places: who is not in contact there is no candidate
constexpr double kLeastShownAngle = 1e-7;  // deg
constexpr double kLeastShownVector = 1e-9; // 1

/// A time in the unit, and in that of the same law by reference<double>.
struct Ratios {
    Quartiles unit, own;
};

std::size_t place_of(const Contenders& contenders, const std::string& name) {
    const auto found =
        std::find_if(contenders.begin(), contenders.end(), [&](const Contender& one) { return one.name == name; });
    return static_cast<std::size_t>(found - contenders.begin());
}

std::vector<double> unit_ratios(const Measured& measured, std::size_t contender) {
    std::vector<double> ratios;
    for (const Round& round : measured.rounds)
        ratios.push_back(round.seconds[contender] / round.unit);
    return ratios;
}

Ratios ratios_of(const Measured& measured, std::size_t contender) {
    const std::size_t reference = place_of(measured.contenders, measured.contenders[contender].reference);
    const Quartiles unit = quartiles(unit_ratios(measured, contender));
    const double own = quartiles(unit_ratios(measured, reference)).median;
    return {unit, {unit.low / own, unit.median / own, unit.high / own}};
}

std::string use_of(const Contender& contender) {
    if (contender.family.starts_with("field"))
        return "volume";
    return contender.family.starts_with("closed loop") ? "loop" : "live";
}

std::string short_name(const Contender& contender) {
    return contender.name.substr(contender.name.find(", ") + 2);
}

const std::vector<Column>& point_columns() {
    static const std::vector<Column> columns{
        {"contender", "", "the law and the way of coming by its force"},
        {"surface", "", "what is compared with each other: same places, errors against the same"},
        {"against", "", "what the errors are against: the smooth shape; where none is known, a law in double"},
        {"family", "", "the way: direct, god-object, look-up, field over a grid, closed loop"},
        {"use", "", "live: one place after the other on one thread; volume: whole grids; loop: steps with a hand"},
        {"shading", "", "as in a scene's [force]"},
        {"precision", "", "of the arithmetic and of what is stored"},
        {"facets", "1", "n of a bump"},
        {"cells", "1", "of a mesh along each side"},
        {"spacing_m", "m", "h of a look-up's volume"},
        {"volume_bytes", "B", "of a look-up's volume"},
        {"time_ratio", "1",
         "median time over the unit's (reference<double> of one law, see the notes) in the same round"},
        {"time_ratio_low", "1", "its lower quartile over the rounds"},
        {"time_ratio_high", "1", "its upper quartile"},
        {"own_time_ratio", "1", "time_ratio over that of reference<double> of the same law, medians"},
        {"own_time_ratio_low", "1", "its lower quartile"},
        {"own_time_ratio_high", "1", "its upper quartile"},
        {"direction_rms_deg", "deg", "angle to the force of what `against` names, root mean square"},
        {"direction_p999_deg", "deg", "likewise, what 99.9 % do not exceed"},
        {"direction_max_deg", "deg", "likewise, the largest"},
        {"magnitude_rms_1", "1",
         "difference of magnitude to the force of what `against` names, of this, root mean square"},
        {"magnitude_p999_1", "1", "likewise, what 99.9 % do not exceed"},
        {"magnitude_max_1", "1", "likewise, the largest"},
        {"vector_rms_1", "1",
         "length of the difference to the force of what `against` names, of this, root mean square"},
        {"vector_p999_1", "1", "likewise, what 99.9 % do not exceed"},
        {"vector_max_1", "1", "likewise, the largest"},
        {"reference_direction_rms_deg", "deg", "angle to the force of reference<double> of the same law, RMS"},
        {"reference_direction_p999_deg", "deg", "likewise, what 99.9 % do not exceed"},
        {"reference_direction_max_deg", "deg", "likewise, the largest"},
        {"reference_magnitude_rms_1", "1",
         "difference of magnitude to reference<double> of the same law, of this, RMS"},
        {"reference_magnitude_p999_1", "1", "likewise, what 99.9 % do not exceed"},
        {"reference_magnitude_max_1", "1", "likewise, the largest"},
        {"reference_vector_rms_1", "1", "length of the difference to reference<double> of the same law, of this, RMS"},
        {"reference_vector_max_1", "1", "likewise, the largest"},
        {"places", "1", "places compared with what `against` names"},
        {"contact_differs", "1",
         "places where only one of both is in contact, what `against` names (one of `places`) or this"},
        {"shown_direction_deg", "deg", "direction_rms_deg, or 1e-7 where it is below that, for pictures"},
        {"shown_vector_1", "1", "vector_rms_1, or 1e-9 where it is below that, for pictures"},
        {"direction_label", "", "its name where it is on the front of directions"},
        {"vector_label", "", "its name where it is on the front of vectors"},
    };
    return columns;
}

// A number of a summary; nothing where there is no summary.
std::optional<double> part(const std::optional<Summary>& summary, double Summary::*number) {
    return summary ? std::optional(*summary.*number) : std::nullopt;
}

// As pictures show it: no less than `least`.
std::optional<double> shown(const std::optional<Summary>& summary, double least) {
    return summary ? std::optional(std::max(summary->rms, least)) : std::nullopt;
}

std::vector<Cell> point_row(const Measured& measured, std::size_t i) {
    const Contender& one = measured.contenders[i];
    const Ratios ratios = ratios_of(measured, i);
    const ForceErrors smooth = measured.compared[i].smooth.value_or(ForceErrors{});
    const ForceErrors exact = measured.compared[i].reference.value_or(ForceErrors{});
    return row_of(one.name, one.subject, one.against, one.family, use_of(one), one.shading, one.precision, one.facets,
                  one.cells, one.spacing, one.bytes, ratios.unit.median, ratios.unit.low, ratios.unit.high,
                  ratios.own.median, ratios.own.low, ratios.own.high, part(smooth.direction, &Summary::rms),
                  part(smooth.direction, &Summary::p999), part(smooth.direction, &Summary::largest),
                  part(smooth.magnitude, &Summary::rms), part(smooth.magnitude, &Summary::p999),
                  part(smooth.magnitude, &Summary::largest), part(smooth.vector, &Summary::rms),
                  part(smooth.vector, &Summary::p999), part(smooth.vector, &Summary::largest),
                  part(exact.direction, &Summary::rms), part(exact.direction, &Summary::p999),
                  part(exact.direction, &Summary::largest), part(exact.magnitude, &Summary::rms),
                  part(exact.magnitude, &Summary::p999), part(exact.magnitude, &Summary::largest),
                  part(exact.vector, &Summary::rms), part(exact.vector, &Summary::largest), double(smooth.compared),
                  double(smooth.contact_differs), shown(smooth.direction, kLeastShownAngle),
                  shown(smooth.vector, kLeastShownVector), std::string(), std::string());
}

// Those that are in contact where they should be: out of contact a force has no direction that could be off.
std::vector<std::size_t> rows_with(const Table& points, const std::string& surface, const std::string& use) {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < points.rows.size(); ++row) {
        const double differs = points.number(row, "contact_differs").value_or(0);
        if (points.word(row, "surface") == surface && points.word(row, "use") == use &&
            differs <= kMostMissed * points.number(row, "places").value_or(0))
            rows.push_back(row);
    }
    return rows;
}

std::vector<double> numbers(const Table& table, const std::vector<std::size_t>& rows, const std::string& column) {
    std::vector<double> values;
    for (const std::size_t row : rows)
        values.push_back(table.number(row, column).value_or(NAN));
    return values;
}

// What a front is about: the error, as it is shown, and the label of those on it.
struct Criterion {
    const char *name, *column, *shown, *label;
};
constexpr std::array<Criterion, 2> kCriteria{
    {{"direction", "direction_rms_deg", "shown_direction_deg", "direction_label"},
     {"vector", "vector_rms_1", "shown_vector_1", "vector_label"}}};
constexpr std::array<const char*, 2> kUses{"live", "volume"};

// Bounds for which the cheapest is named.
struct Bound {
    const char *criterion, *column, *unit;
    double most;
};
constexpr std::array<Bound, 7> kBounds{{{"direction RMS", "direction_rms_deg", "deg", 1},
                                        {"direction RMS", "direction_rms_deg", "deg", 0.1},
                                        {"direction RMS", "direction_rms_deg", "deg", 0.01},
                                        {"largest direction error", "direction_max_deg", "deg", 1},
                                        {"vector RMS", "vector_rms_1", "1", 0.05},
                                        {"vector RMS", "vector_rms_1", "1", 0.01},
                                        {"vector RMS", "vector_rms_1", "1", 0.001}}};

// Of rows: the one with the least error among those that the least median time does not tell from the cheapest, the
// cheaper of two as close; nothing of none.
std::optional<std::size_t> cheapest_of(const Table& points, const std::vector<std::size_t>& rows,
                                       const std::string& error) {
    const auto value = [&](std::size_t row, const std::string& column) {
        return points.number(row, column).value_or(INFINITY);
    };
    double least = INFINITY;
    for (const std::size_t row : rows)
        least = std::min(least, value(row, "time_ratio"));
    std::optional<std::size_t> best;
    for (const std::size_t row : rows) {
        if (std::min(value(row, "time_ratio_low"), value(row, "time_ratio")) > least)
            continue;
        if (!best || std::pair(value(row, error), value(row, "time_ratio")) <
                         std::pair(value(*best, error), value(*best, "time_ratio")))
            best = row;
    }
    return best;
}

// All, or those alone whose smooth shape is known.
std::vector<std::string> surfaces_of(const Table& points, bool known_shape = false) {
    std::vector<std::string> names;
    for (std::size_t row = 0; row < points.rows.size(); ++row)
        if ((!known_shape || points.word(row, "against") == kSmoothShape) &&
            std::find(names.begin(), names.end(), points.word(row, "surface")) == names.end())
            names.push_back(points.word(row, "surface"));
    return names;
}

} // namespace

Table point_table(const Measured& measured) {
    Table table{"points", "Every way of coming by a force: error and time", point_columns(), {}};
    for (std::size_t i = 0; i < measured.contenders.size(); ++i)
        table.rows.push_back(point_row(measured, i));
    for (const std::string& surface : surfaces_of(table))
        for (const char* use : kUses)
            for (const Criterion& criterion : kCriteria) {
                const auto rows = rows_with(table, surface, use);
                for (const std::size_t at :
                     pareto_front(numbers(table, rows, "time_ratio"), numbers(table, rows, criterion.shown)))
                    table.rows[rows[at]][table.index(criterion.label)] = short_name(measured.contenders[rows[at]]);
            }
    return table;
}

Table front_table(const Table& points) {
    Table table{"front",
                "The Pareto fronts: nothing is both cheaper and closer, of what is in contact where it should be, but "
                "for 1 % of the places",
                {{"surface", "", "as in points"},
                 {"use", "", "as in points: fronts of live use and of whole grids are apart"},
                 {"criterion", "", "direction: RMS angle in degrees; vector: RMS of the relative error of the force"},
                 {"contender", "", "as in points"},
                 {"time_ratio", "1", "as in points"},
                 {"error", "deg or 1", "the criterion's error"},
                 {"shown_error", "deg or 1", "the same, or the least that pictures show"}},
                {}};
    for (const std::string& surface : surfaces_of(points))
        for (const char* use : kUses)
            for (const Criterion& criterion : kCriteria) {
                const auto rows = rows_with(points, surface, use);
                for (const std::size_t at :
                     pareto_front(numbers(points, rows, "time_ratio"), numbers(points, rows, criterion.shown)))
                    table.rows.push_back(
                        row_of(surface, std::string(use), std::string(criterion.name),
                               points.word(rows[at], "contender"), points.number(rows[at], "time_ratio"),
                               points.number(rows[at], criterion.column), points.number(rows[at], criterion.shown)));
            }
    return table;
}

Table cheapest_table(const Table& points) {
    Table table{
        "cheapest",
        "The cheapest within a bound off a known smooth shape, of what is in contact where this is, but for 1 % of "
        "the places",
        {{"surface", "", "as in points"},
         {"use", "", "as in points"},
         {"criterion", "", "what is bounded"},
         {"bound", "deg or 1", "the most that it may be"},
         {"bound_unit", "", "of the bound"},
         {"contender", "",
          "the cheapest that keeps to it, nothing if none does: of those whose lower quartile of time is no more than "
          "the least median, which these rounds do not tell apart, the one with the least error"},
         {"time_ratio", "1", "its time, as in points"},
         {"error", "deg or 1", "what it has of the criterion"},
         {"candidates", "1", "how many keep to the bound"}},
        {}};
    for (const std::string& surface : surfaces_of(points, true))
        for (const char* use : kUses)
            for (const Bound& bound : kBounds) {
                std::vector<std::size_t> within = rows_with(points, surface, use);
                std::erase_if(within, [&](std::size_t row) {
                    return !(points.number(row, bound.column).value_or(INFINITY) <= bound.most);
                });
                const auto best = cheapest_of(points, within, bound.column);
                table.rows.push_back(
                    row_of(surface, std::string(use), std::string(bound.criterion), bound.most, std::string(bound.unit),
                           best ? points.word(*best, "contender") : std::string(),
                           best ? points.number(*best, "time_ratio") : std::nullopt,
                           best ? points.number(*best, bound.column) : std::nullopt, double(within.size())));
            }
    return table;
}

} // namespace forceshade::study::error_time
