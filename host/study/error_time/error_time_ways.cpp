#include "host/study/error_time/error_time_ways.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/study/data/median.h"
#include "host/study/error_time/error_time_lookups.h"
#include "host/study/error_time/error_time_points.h"

namespace forceshade::study {
namespace {

Row largest(const Table& points, const std::vector<std::pair<Row, Row>>& of, std::string_view column) {
    return std::ranges::max_element(
               of, {}, [&](const auto& one) { return points.number(one.first, column).value_or(-INFINITY); })
        ->first;
}

std::string laws(std::size_t count) {
    return fmt::format("{} law{}", count, count == 1 ? "" : "s");
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
    const Row any = both.front().first;
    const bool known = has_smooth_shape(points, any);
    const std::string of =
        known ? std::string("the smooth shape's") : points.word(any, "against") + " by the god-object";
    findings.push_back(
        {"god_object",
         fmt::format(
             "Along strokes on a mesh the god-object {} the static field (median of {}); its direction is up to "
             "{:.2g}° RMS off {}, the static field's up to {:.2g}°{}.",
             against(median_ratio(points, both, "time_ratio")), laws(both.size()), error, of, other_error,
             known ? "" : " off that by the static field")});
}

// Each shading of a surface whose smooth shape is known against flat facets, as many of them, both evaluated directly
// in f64.
void add_shadings(std::vector<Finding>& findings, const Table& points) {
    std::vector<std::string> done;
    const Way direct{"direct", "f64"};
    for (Row first = 0; first < points.rows.size(); ++first) {
        const std::string shading = points.word(first, "shading"), surface = points.word(first, "surface");
        const std::string name = fmt::format("shading_{}_{}", surface, shading);
        if (shading == "none" || !has_smooth_shape(points, first) || std::ranges::find(done, name) != done.end())
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
    add_lookups(findings, points);
    add_god_object(findings, points);
    add_kernel(findings, data, points);
    add_precision(findings, points);
    add_loop(findings, points);
}

} // namespace forceshade::study
