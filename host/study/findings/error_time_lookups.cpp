#include "host/study/findings/error_time_lookups.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/study/findings/error_time_points.h"

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

void add_tricubic(std::vector<Finding>& findings, const Table& points) {
    std::vector<double> times, errors;
    for (Row one = 0; one < points.rows.size(); ++one)
        for (Row other = 0; other < points.rows.size(); ++other)
            if (is(points, one, {"look-up, tricubic", "f32"}) && is(points, other, {"look-up, trilinear", "f32"}) &&
                law_of(points, one) == law_of(points, other) &&
                points.number(one, "spacing_m") == points.number(other, "spacing_m")) {
                times.push_back(value(points, one, "time_ratio") / value(points, other, "time_ratio"));
                errors.push_back(value(points, one, "reference_vector_rms_1") /
                                 value(points, other, "reference_vector_rms_1"));
            }
    if (times.empty())
        return;
    const double error = median(errors);
    findings.push_back(
        {"tricubic",
         fmt::format("Tricubic look-up {} trilinear at the same spacing, and its error is {:.2g} times as large: {}.",
                     against(median(times)), error,
                     error > 1     ? "edges, not curvature, are what a volume gets wrong"
                     : error > 0.5 ? "it is hardly worth its price"
                                   : "it pays off")});
}

} // namespace

void add_lookups(std::vector<Finding>& findings, const Table& points) {
    add_lookup(findings, points);
    add_tricubic(findings, points);
}

} // namespace forceshade::study
