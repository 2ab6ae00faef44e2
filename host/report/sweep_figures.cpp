// What a sweep varies, and how far its forces are from those that should be, where a hand touches.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <map>
#include <optional>
#include <set>

#include <fmt/format.h>

#include "host/report/sections.h"
#include "host/report/words.h"

namespace forceshade::report {
namespace {

// The number that a parameter begins with: of "600 mil" 600.
std::optional<double> leading_number(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() ? std::optional(value) : std::nullopt;
}

std::string parameter(const CaseRecord& record, const std::string& key) {
    const auto found = std::ranges::find(record.parameters, key, [](const auto& one) { return one.first; });
    return found == record.parameters.end() ? "" : found->second;
}

struct Touched {
    const CaseRecord* record = nullptr;
    double x = 0;
    std::string series; /* the other parameters */
};

// The parameter with the most numbers; empty: none varies.
std::string axis_of(const std::vector<const CaseRecord*>& cases) {
    std::map<std::string, std::set<double>> numbers;
    for (const CaseRecord* record : cases)
        for (const auto& [key, text] : record->parameters)
            if (const auto value = leading_number(text))
                numbers[key].insert(*value);
    std::string axis;
    std::size_t most = 1;
    for (const auto& [key, values] : numbers)
        if (values.size() > most) {
            most = values.size();
            axis = key;
        }
    return axis;
}

std::vector<const CaseRecord*> touched_cases(const Sweep& sweep) {
    std::vector<const CaseRecord*> cases;
    for (const CaseRecord& record : sweep.cases)
        if (record.touch)
            cases.push_back(&record);
    return cases;
}

std::vector<Touched> touched_of(const std::vector<const CaseRecord*>& cases, const std::string& axis) {
    std::map<std::string, std::set<std::string>> values;
    for (const CaseRecord* record : cases)
        for (const auto& [key, value] : record->parameters)
            values[key].insert(value);
    std::vector<Touched> rows;
    for (const CaseRecord* record : cases) {
        const auto x = leading_number(parameter(*record, axis));
        if (!x)
            continue;
        Touched row{record, *x, {}};
        for (const auto& [key, value] : record->parameters)
            if (key != axis && values[key].size() > 1)
                row.series += (row.series.empty() ? "" : ", ") + (key == "shading" ? value : key + " " + value);
        rows.push_back(std::move(row));
    }
    std::vector<std::string> order; // in which series come
    for (const Touched& row : rows)
        if (std::ranges::find(order, row.series) == order.end())
            order.push_back(row.series);
    std::ranges::stable_sort(rows, {}, [&](const Touched& row) {
        return std::pair(std::ranges::find(order, row.series) - order.begin(), row.x);
    });
    return rows;
}

std::string unit_of(const std::vector<const CaseRecord*>& cases, const std::string& axis) {
    const std::string text = parameter(*cases.front(), axis);
    const std::size_t space = text.find(' ');
    return space == std::string::npos ? axis : axis + " / " + text.substr(space + 1);
}

study::Figure figure_of(const std::string& name, const std::string& title, const study::FigureAxis& x,
                        const study::FigureAxis& y, const CaseRecord& first) {
    study::Figure figure = study::make_figure(
        name, title,
        fmt::format("Against {}, at {} places anywhere on the surface, {:.3g} to {:.3g} mm below it, log-uniform.",
                    first.touch->against, first.touch->places, 10 * first.touch->deepest, 1e3 * first.touch->deepest),
        study::FigureKind::scatter, "touch", {}, x, y, "series");
    figure.joined = true;
    return figure;
}

// The least and the largest of some numbers, of one alone that.
std::string range_text(std::vector<double> values, double factor) {
    constexpr double kNothing = 1e-9; // deg or 1: rounding
    const auto [least, most] = std::ranges::minmax(values);
    const auto text = [&](double value) { return number_text(value < kNothing ? 0 : factor * value, 2); };
    const std::string low = text(least), high = text(most);
    return low == high ? low : low + " to " + high;
}

} // namespace

void add_touch_figures(const Sweep& sweep, study::StudyData& data) {
    const std::vector<const CaseRecord*> cases = touched_cases(sweep);
    const std::string axis = axis_of(cases);
    if (axis.empty())
        return;
    const std::vector<Touched> rows = touched_of(cases, axis);
    using R = Touched;
    data.tables.push_back(
        study::table_of<R>("touch", "Errors where a hand touches",
                           {{"case", "", "", [](const R& r) { return r.record->name; }},
                            {axis, "1", "", &R::x},
                            {"series", "", "the other parameters", &R::series},
                            {"direction_deg", "deg", "angle to the force that should be there, root mean square",
                             [](const R& r) { return r.record->touch->direction_rms; }},
                            {"force_percent", "%", "|F - F_true| / |F_true|, median",
                             [](const R& r) { return 100 * r.record->touch->median_error; }},
                            {"force_p95_percent", "%", "the same, 95th percentile",
                             [](const R& r) { return 100 * r.record->touch->p95_error; }}},
                           rows));
    const auto [least, most] = std::ranges::minmax(rows, {}, &R::x);
    const study::FigureAxis x{axis, unit_of(cases, axis), least.x > 0 && most.x / least.x > 16};
    data.figures.push_back(figure_of("touch-direction", "Error of the force's direction over " + axis, x,
                                     {"direction_deg", "RMS error of the direction / deg"}, *cases.front()));
    data.figures.push_back(figure_of("touch-force", "Error of the force over " + axis, x,
                                     {"force_percent", "median error of the force / % of the force there"},
                                     *cases.front()));
}

std::string touch_finding(const Sweep& sweep) {
    const std::vector<const CaseRecord*> cases = touched_cases(sweep);
    std::vector<double> plain_angles, shaded_angles, plain_errors, shaded_errors, angles, errors;
    for (const CaseRecord* record : cases) {
        const std::string shading = parameter(*record, "shading");
        angles.push_back(record->touch->direction_rms);
        errors.push_back(record->touch->median_error);
        if (shading.empty())
            continue;
        (shading == "none" ? plain_angles : shaded_angles).push_back(record->touch->direction_rms);
        (shading == "none" ? plain_errors : shaded_errors).push_back(record->touch->median_error);
    }
    if (cases.empty())
        return "";
    const std::string against = cases.front()->touch->against;
    if (plain_angles.empty() || shaded_angles.empty())
        return fmt::format("Where a hand touches, the force's direction is {} deg (RMS) from that of {}, and the force "
                           "{} % (median).",
                           range_text(angles, 1), against, range_text(errors, 100));
    return fmt::format(
        "Where a hand touches, the force's direction is {} deg from that of {} without shading and {} deg "
        "with it (RMS, by case); the whole force errs by {} % and by {} % (median).",
        range_text(plain_angles, 1), against, range_text(shaded_angles, 1), range_text(plain_errors, 100),
        range_text(shaded_errors, 100));
}

} // namespace forceshade::report
