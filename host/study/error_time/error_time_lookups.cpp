#include "host/study/error_time/error_time_lookups.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/study/data/median.h"
#include "host/study/error_time/error_time_points.h"

namespace forceshade::study {
namespace {

// "0.8, 0.4 and 0.2 mm"
std::string spacings_text(const Table& points, const std::vector<Row>& rows) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i)
        text += fmt::format("{}{:.3g}",
                            i == 0                 ? ""
                            : i + 1 == rows.size() ? " and "
                                                   : ", ",
                            points.needed(rows[i], "spacing_m") * 1e3);
    return text + " mm";
}

// The trilinear volumes of a law, the coarsest first; but for those without a number to compare.
std::vector<Row> volumes_of(const Table& points, const std::string& law) {
    std::vector<Row> rows;
    for (Row row = 0; row < points.rows.size(); ++row)
        if (law_of(points, row) == law && is(points, row, {"look-up, trilinear", "f32"}) &&
            points.number(row, "spacing_m") && points.number(row, "own_time_ratio") &&
            points.number(row, "reference_direction_rms_deg"))
            rows.push_back(row);
    std::ranges::stable_sort(rows, std::ranges::greater(), [&](Row row) { return value(points, row, "spacing_m"); });
    return rows;
}

// "volume of 0.8 mm (0.085 MB) takes as long as evaluating it directly in f64, and is 0.05° RMS off that"
std::string volume_text(const Table& points, Row row) {
    return fmt::format("volume of {:.3g} mm ({:.2g} MB) {} evaluating it directly in f64, and is {:.2g}° RMS off that",
                       value(points, row, "spacing_m") * 1e3, value(points, row, "volume_bytes") * 1e-6,
                       against(value(points, row, "own_time_ratio")),
                       value(points, row, "reference_direction_rms_deg"));
}

// Which of these volumes, the coarsest first, save time.
std::string saving_text(const Table& points, const std::vector<Row>& volumes) {
    std::vector<Row> cheaper = volumes;
    std::erase_if(cheaper, [&](Row row) { return value(points, row, "own_time_ratio") >= kCheaper; });
    if (cheaper.empty())
        return volumes.size() == 1 ? "here a volume saves nothing" : "here no volume that was tried saves anything";
    if (cheaper.size() == volumes.size())
        return volumes.size() == 1 ? "here a volume saves time" : "every volume that was tried saves time";
    const Row closest = *std::ranges::min_element(
        cheaper, {}, [&](Row row) { return value(points, row, "reference_direction_rms_deg"); });
    return fmt::format("of those tried, {} save{} time{}", spacings_text(points, cheaper),
                       cheaper.size() == 1 ? "s" : "",
                       cheaper.size() == 1 && closest == volumes.front()
                           ? std::string()
                           : fmt::format(", the closest of these with {:.2g} times the time and {:.2g}°",
                                         value(points, closest, "own_time_ratio"),
                                         value(points, closest, "reference_direction_rms_deg")));
}

// "_64" of a law of 64 facets or cells, nothing where it has no number of these.
std::string elements_suffix(const Table& points, Row row) {
    const auto facets = points.number(row, "facets"), cells = points.number(row, "cells");
    return facets || cells ? fmt::format("_{:g}", facets ? *facets : *cells) : "";
}

// The look-ups of a law, the coarsest and the finest, against its direct evaluation.
void add_lookup(std::vector<Finding>& findings, const Table& points) {
    std::vector<std::string> done;
    for (Row row = 0; row < points.rows.size(); ++row) {
        const std::string law = law_of(points, row);
        if (!is(points, row, {"look-up, trilinear", "f32"}) || std::ranges::find(done, law) != done.end())
            continue;
        done.push_back(law);
        const std::vector<Row> volumes = volumes_of(points, law);
        if (volumes.empty())
            continue;
        std::string text = fmt::format("Reading \"{}\" from a trilinear {}", law, volume_text(points, volumes.front()));
        if (volumes.size() > 1)
            text += fmt::format("; a {}", volume_text(points, volumes.back()));
        findings.push_back({"lookup_" + points.word(row, "surface") + elements_suffix(points, row),
                            fmt::format("{}: {}.", text, saving_text(points, volumes))});
    }
}

// A law's tricubic volumes, and the trilinear ones of the same spacing; but for those without a number to compare.
std::vector<std::pair<Row, Row>> tricubic_of(const Table& points, const std::string& law) {
    auto rows = pairs(points, {"look-up, tricubic", "f32"}, {"look-up, trilinear", "f32"});
    std::erase_if(rows, [&](const auto& both) {
        const auto ratio = [&](const char* column) {
            return value(points, both.first, column) / value(points, both.second, column);
        };
        return law_of(points, both.first) != law || !points.number(both.first, "spacing_m") ||
               points.number(both.first, "spacing_m") != points.number(both.second, "spacing_m") ||
               !std::isfinite(ratio("reference_direction_rms_deg")) || !std::isfinite(ratio("reference_vector_rms_1"));
    });
    return rows;
}

// "21 to 545 times smaller", "0.9 to 2.1 times as large": a column of the first of each pair, of that of the second.
std::string range_text(const Table& points, const std::vector<std::pair<Row, Row>>& of, const char* column) {
    std::vector<double> ratios;
    for (const auto& [one, other] : of)
        ratios.push_back(value(points, one, column) / value(points, other, column));
    const auto [low, high] = std::ranges::minmax(ratios);
    const auto text = [](double from, double to) {
        const std::string first = fmt::format("{:.3g}", from), last = fmt::format("{:.3g}", to);
        return first == last ? first : first + " to " + last;
    };
    return high < 1 ? text(1 / high, 1 / low) + " times smaller" : text(low, high) + " times as large";
}

// The spacings at which an error falls by more than the time rises: "every spacing", "no spacing", "0.8 and 0.4 mm".
std::string paying_text(const Table& points, const std::vector<std::pair<Row, Row>>& of, const char* error) {
    std::vector<Row> paying;
    for (const auto& [one, other] : of)
        if (value(points, one, error) * value(points, one, "time_ratio") <
            value(points, other, error) * value(points, other, "time_ratio"))
            paying.push_back(one);
    return paying.empty() ? "no spacing" : paying.size() == of.size() ? "every spacing" : spacings_text(points, paying);
}

void add_tricubic(std::vector<Finding>& findings, const Table& points) {
    constexpr const char* kDirection = "reference_direction_rms_deg";
    constexpr const char* kVector = "reference_vector_rms_1";
    std::vector<std::string> done;
    for (Row row = 0; row < points.rows.size(); ++row) {
        const std::string law = law_of(points, row);
        if (!is(points, row, {"look-up, tricubic", "f32"}) || std::ranges::find(done, law) != done.end())
            continue;
        done.push_back(law);
        const auto both = tricubic_of(points, law);
        if (both.empty())
            continue;
        const std::string direction = paying_text(points, both, kDirection),
                          vector = paying_text(points, both, kVector);
        findings.push_back(
            {"tricubic_" + points.word(row, "surface") + elements_suffix(points, row),
             fmt::format(
                 "Reading \"{}\" tricubic {} trilinear of the same spacing (median of {} volume{}); its direction "
                 "error against direct evaluation is {}, the error of the whole force {}: where the error should "
                 "fall by more than the time rises, it pays off {}.",
                 law, against(median_ratio(points, both, "time_ratio")), both.size(), both.size() == 1 ? "" : "s",
                 range_text(points, both, kDirection), range_text(points, both, kVector),
                 direction == vector
                     ? "at " + direction
                     : fmt::format("for the direction at {}, for the whole force at {}", direction, vector))});
    }
}

} // namespace

void add_lookups(std::vector<Finding>& findings, const Table& points) {
    add_lookup(findings, points);
    add_tricubic(findings, points);
}

} // namespace forceshade::study
