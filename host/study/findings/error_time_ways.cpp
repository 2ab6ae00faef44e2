#include "host/study/findings/error_time_ways.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>

#include <fmt/format.h>

namespace forceshade::study {
namespace {

using Row = std::size_t;

// What a row must be.
struct Way {
    std::string family, precision;
    bool prefix = false; // of the family
};

bool is(const Table& points, Row row, const Way& way) {
    const std::string family = points.word(row, "family");
    return (way.prefix ? family.starts_with(way.family) : family == way.family) &&
           points.word(row, "precision") == way.precision;
}

// "bump, 64 facets, shaded" of "bump, 64 facets, shaded: direct f64"
std::string law_of(const Table& points, Row row) {
    const std::string name = points.word(row, "contender");
    return name.substr(0, name.find(':'));
}

// Rows of the same law, one of each way.
std::vector<std::pair<Row, Row>> pairs(const Table& points, const Way& one, const Way& other) {
    std::vector<std::pair<Row, Row>> result;
    for (Row row = 0; row < points.rows.size(); ++row)
        for (Row with = 0; with < points.rows.size(); ++with)
            if (is(points, row, one) && is(points, with, other) && law_of(points, row) == law_of(points, with))
                result.emplace_back(row, with);
    return result;
}

double value(const Table& points, Row row, std::string_view column) {
    return points.number(row, column).value_or(NAN);
}

double median(std::vector<double> values) {
    std::erase_if(values, [](double one) { return !std::isfinite(one); });
    if (values.empty())
        return NAN;
    std::sort(values.begin(), values.end());
    const std::size_t half = values.size() / 2;
    return values.size() % 2 ? values[half] : (values[half - 1] + values[half]) / 2;
}

// Of the pairs: a column of the first over that of the second.
double median_ratio(const Table& points, const std::vector<std::pair<Row, Row>>& of, std::string_view column) {
    std::vector<double> ratios;
    for (const auto& [one, other] : of)
        ratios.push_back(value(points, one, column) / value(points, other, column));
    return median(std::move(ratios));
}

Row largest(const Table& points, const std::vector<std::pair<Row, Row>>& of, std::string_view column) {
    return std::ranges::max_element(
               of, {}, [&](const auto& one) { return points.number(one.first, column).value_or(-INFINITY); })
        ->first;
}

std::string laws(std::size_t count) {
    return fmt::format("{} law{}", count, count == 1 ? "" : "s");
}

constexpr double kCheaper = 0.95; // of a time: below this it is told as less

// "takes 1.3 times as long as", to stand between two ways.
std::string against(double ratio) {
    if (ratio < kCheaper)
        return fmt::format("takes {:.2g} times the time of", ratio);
    if (ratio > 1.05)
        return fmt::format("takes {:.2g} times as long as", ratio);
    return "takes as long as";
}

// "0.8, 0.4 and 0.2 mm"
std::string spacings_text(const Table& points, const std::vector<Row>& rows) {
    std::string text;
    for (std::size_t i = 0; i < rows.size(); ++i)
        text += fmt::format("{}{:g}",
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
    return fmt::format("volume of {:g} mm ({:.2g} MB) {} evaluating it directly in f64, and is {:.2g}° RMS off that",
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
        findings.push_back(
            {"lookup_" + points.word(row, "surface"), fmt::format("{}: {}.", text, saving_text(points, volumes))});
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

void add_precision(std::vector<Finding>& findings, const Table& points) {
    const auto singles = pairs(points, {"direct", "f32"}, {"direct", "f64"});
    const auto halves = pairs(points, {"direct", "f32, half output"}, {"direct", "f64"});
    if (singles.empty())
        return;
    std::vector<double> errors;
    for (const auto& [one, other] : singles)
        errors.push_back(value(points, one, "reference_vector_rms_1"));
    const Row worst = largest(points, singles, "reference_direction_max_deg");
    findings.push_back(
        {"single_precision",
         fmt::format("Single precision {} double on the CPU (median of {}) and is {:.2g} of the force off it, "
                     "RMS; the worst direction is "
                     "{:.2g}° off, of \"{}\".",
                     against(median_ratio(points, singles, "time_ratio")), laws(singles.size()), median(errors),
                     value(points, worst, "reference_direction_max_deg"), law_of(points, worst))});
    if (halves.empty())
        return;
    const Row half = largest(points, halves, "reference_vector_max_1");
    findings.push_back(
        {"half_output",
         fmt::format("Half output {} double, and is at most {:.2g} of the force off it ({:.2g}°).",
                     against(median_ratio(points, halves, "time_ratio")), value(points, half, "reference_vector_max_1"),
                     value(points, half, "reference_direction_max_deg"))});
}

void add_kernel(std::vector<Finding>& findings, const StudyData& data, const Table& points) {
    const auto kernels = pairs(points, {"field, kernel", "f32"}, {"field, CPU on one thread", "f32"});
    const auto doubles = pairs(points, {"field, kernel", "f64"}, {"field, CPU on one thread", "f64"});
    if (kernels.empty())
        return;
    std::string text = fmt::format(
        "The kernel on {} ({} cores{}) {} the CPU oracle over the same grid on one thread in f32", data.device,
        data.cores, data.software ? ", a software device" : "", against(median_ratio(points, kernels, "time_ratio")));
    if (!doubles.empty())
        text += fmt::format(", and {} it in f64", against(median_ratio(points, doubles, "time_ratio")));
    double off = 0;
    for (const auto& [one, other] : kernels)
        off = std::max(off, std::abs(value(points, one, "reference_vector_max_1") -
                                     value(points, other, "reference_vector_max_1")));
    text +=
        off == 0 ? "; both are equally far from double." : fmt::format("; their largest errors differ by {:.2g}.", off);
    findings.push_back({"kernel", text});
}

void add_god_object(std::vector<Finding>& findings, const Table& points) {
    const auto both = pairs(points, {"god-object", "f64"}, {"direct", "f64"});
    if (both.empty())
        return;
    double error = 0, other_error = 0;
    for (const auto& [one, other] : both) {
        error = std::max(error, value(points, one, "direction_rms_deg"));
        other_error = std::max(other_error, value(points, other, "direction_rms_deg"));
    }
    findings.push_back(
        {"god_object",
         fmt::format(
             "Along strokes on a mesh the god-object {} the static field (median of {}); its direction is up to "
             "{:.2g}° RMS off the smooth shape's, the static field's up to {:.2g}°.",
             against(median_ratio(points, both, "time_ratio")), laws(both.size()), error, other_error)});
}

// Each shading of a surface against flat facets, as many of them, both evaluated directly in f64.
void add_shadings(std::vector<Finding>& findings, const Table& points) {
    std::vector<std::string> done;
    const Way direct{"direct", "f64"};
    for (Row first = 0; first < points.rows.size(); ++first) {
        const std::string shading = points.word(first, "shading"), surface = points.word(first, "surface");
        const std::string name = fmt::format("shading_{}_{}", surface, shading);
        if (shading == "none" || std::ranges::find(done, name) != done.end())
            continue;
        done.push_back(name);
        std::vector<double> times, errors;
        for (Row one = 0; one < points.rows.size(); ++one)
            for (Row flat = 0; flat < points.rows.size(); ++flat)
                if (is(points, one, direct) && is(points, flat, direct) && points.word(one, "shading") == shading &&
                    points.word(flat, "shading") == "none" && points.word(one, "surface") == surface &&
                    points.word(flat, "surface") == surface &&
                    points.number(one, "facets") == points.number(flat, "facets") &&
                    points.number(one, "cells") == points.number(flat, "cells")) {
                    times.push_back(value(points, one, "time_ratio") / value(points, flat, "time_ratio"));
                    errors.push_back(value(points, one, "direction_rms_deg") /
                                     value(points, flat, "direction_rms_deg"));
                }
        const double time = median(times), error = median(errors);
        if (!std::isfinite(time) || !std::isfinite(error))
            continue;
        const std::string less = error < 1e-6 ? std::string("none of their direction error")
                                              : fmt::format("{:.2g} times their direction error", error);
        findings.push_back({name, fmt::format("On the {}, shading \"{}\" {} flat facets, as many of them, and has {}.",
                                              surface, shading, against(time), less)});
    }
}

void add_loop(std::vector<Finding>& findings, const Table& points) {
    const auto steps = pairs(points, {"closed loop, CPU on one thread", "f64"}, {"direct", "f64"});
    const auto singles =
        pairs(points, {"closed loop, CPU on one thread", "f32"}, {"closed loop, CPU on one thread", "f64"});
    if (steps.empty() || singles.empty())
        return;
    const Row worst = largest(points, singles, "reference_vector_max_1");
    findings.push_back(
        {"closed_loop", fmt::format("A step of a closed loop, hand and metrics included, {} a direct evaluation "
                                    "(median of {}); in f32 the "
                                    "force of a step is at most {:.2g} of itself off the same step in f64, of \"{}\".",
                                    against(median_ratio(points, steps, "time_ratio")), laws(steps.size()),
                                    value(points, worst, "reference_vector_max_1"), law_of(points, worst))});
}

} // namespace

void add_ways(std::vector<Finding>& findings, const StudyData& data) {
    const Table& points = data.table("points");
    add_shadings(findings, points);
    add_lookup(findings, points);
    add_tricubic(findings, points);
    add_god_object(findings, points);
    add_kernel(findings, data, points);
    add_precision(findings, points);
    add_loop(findings, points);
}

} // namespace forceshade::study
