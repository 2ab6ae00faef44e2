// A sweep: the facts of its manifest, its cases, their errors and times, what was left out, the files; what it varies,
// and how far its forces are from those that should be, where a hand touches.
#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <tuple>

#include <fmt/format.h>

#include "host/report/sections.h"

namespace forceshade::report {
namespace {

using R = const CaseRecord*;
using Rows = std::vector<R>;
using Columns = std::vector<study::ColumnOf<R>>;

template <typename Has> Rows cases_with(const Sweep& sweep, const Has& has) {
    Rows cases;
    for (const CaseRecord& record : sweep.cases)
        if (has(record))
            cases.push_back(&record);
    return cases;
}
Rows with_field(const Sweep& sweep) {
    return cases_with(sweep, [](const CaseRecord& record) { return record.voxels > 0; });
}
Rows with_touch(const Sweep& sweep) {
    return cases_with(sweep, [](const CaseRecord& record) { return record.touch.has_value(); });
}
Rows with_compare(const Sweep& sweep) {
    return cases_with(sweep, [](const CaseRecord& record) { return record.deviation && record.deviation->angles > 0; });
}
Rows with_paths(const Sweep& sweep) {
    return cases_with(sweep, [](const CaseRecord& record) { return record.paths.has_value(); });
}

template <typename Count> std::uint64_t sum_of(const Rows& cases, const Count& count) {
    std::uint64_t sum = 0;
    for (const CaseRecord* one : cases)
        sum += std::invoke(count, *one);
    return sum;
}

// The number that a parameter begins with, and its unit: of "600 mil" 600 and " mil".
struct Measure {
    double number = 0;
    std::string unit;
};
std::optional<Measure> measure_of(const std::string& text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() ? std::optional(Measure{value, {end, text.data() + text.size()}}) : std::nullopt;
}
std::optional<double> leading_number(const std::string& text) {
    const auto measure = measure_of(text);
    return measure ? std::optional(measure->number) : std::nullopt;
}

struct Plotted {
    const CaseRecord* record = nullptr;
    study::Cell x{};
    std::string series, panel{};
};

// What errors are drawn over: a number that the sweep varies, the facets first, with points that lines join; else bars,
// over words that vary, as the files of meshes, else over the cases. Where shading varies, too, another number has a
// panel each; the other parameters are series.
struct Axes {
    std::string axis, panel; /* parameters; empty: the cases, no panels */
    bool numbers = false;
    std::vector<Plotted> rows;
    study::FigureAxis x;
};

using Values = std::map<std::string, std::set<std::string>>; /* of each parameter */

Values values_of(const Rows& cases) {
    Values values;
    for (const CaseRecord* record : cases)
        for (const auto& [key, value] : record->parameters)
            values[key].insert(value);
    return values;
}

// Of the parameters that vary the one with the most values, of those that `fits`; empty: none.
template <typename Fits> std::string most_varied(const Values& values, const Fits& fits) {
    std::string axis;
    std::size_t most = 1;
    for (const auto& [key, texts] : values)
        if (texts.size() > most && fits(key, texts)) {
            most = texts.size();
            axis = key;
        }
    return axis;
}

bool are_numbers(const std::set<std::string>& texts) {
    return std::ranges::all_of(texts, [](const std::string& text) { return leading_number(text).has_value(); });
}

// Whether all are numbers of one unit, whose places on an axis are theirs.
bool have_one_unit(const std::set<std::string>& texts) {
    const auto first = measure_of(*texts.begin());
    return std::ranges::all_of(texts, [&](const std::string& text) {
        const auto measure = measure_of(text);
        return measure && measure->unit == first->unit;
    });
}

std::vector<Plotted> plotted_of(const Rows& cases, const std::string& axis, bool numbers, const std::string& panel) {
    const Values values = values_of(cases);
    std::vector<Plotted> rows;
    for (const CaseRecord* record : cases) {
        Plotted row{record, record->name, {}};
        if (!axis.empty()) {
            const std::string text = record->parameter(axis);
            if (numbers && text.empty())
                continue; // as a smooth bump, which has no facets
            row.x = numbers ? study::Cell(*leading_number(text)) : study::Cell(text.empty() ? "–" : text);
        }
        for (const auto& [key, value] : record->parameters)
            if (key == panel)
                row.panel = key + " " + value;
            else if (key != axis && values.at(key).size() > 1)
                row.series += (row.series.empty() ? "" : ", ") + (key == "shading" ? value : key + " " + value);
        rows.push_back(std::move(row));
    }
    if (!numbers)
        return rows;
    const auto place_among = [](const std::vector<std::string>& all, const std::string& one) {
        return std::ranges::find(all, one) - all.begin();
    };
    std::vector<std::string> series, panels; // in the order of the cases
    for (const Plotted& row : rows) {
        if (place_among(series, row.series) == std::ssize(series))
            series.push_back(row.series);
        if (place_among(panels, row.panel) == std::ssize(panels))
            panels.push_back(row.panel);
    }
    std::ranges::stable_sort(rows, {}, [&](const Plotted& row) {
        return std::tuple(place_among(series, row.series), place_among(panels, row.panel), std::get<double>(row.x));
    });
    return rows;
}

std::string unit_of(const Rows& cases, const std::string& axis) {
    const std::string text = cases.front()->parameter(axis);
    const std::size_t space = text.find(' ');
    return space == std::string::npos ? axis : axis + " / " + text.substr(space + 1);
}

Axes axes_of(const Rows& cases) {
    const Values values = values_of(cases);
    const auto varies = [&](const char* key) { return values.contains(key) && values.at(key).size() > 1; };
    const auto is_axis = [](const std::string&, const auto& texts) { return have_one_unit(texts); };
    std::string axis = varies("facets") ? "facets" : most_varied(values, is_axis);
    const bool numbers = !axis.empty();
    if (!numbers)
        axis = most_varied(values, [](const std::string& key, const auto&) { return key != "shading"; });
    if (axis.empty() && varies("shading"))
        axis = "shading";
    const auto is_panel = [&](const std::string& key, const auto& texts) { return key != axis && are_numbers(texts); };
    const std::string panel = numbers && varies("shading") ? most_varied(values, is_panel) : "";
    Axes axes{axis, panel, numbers, plotted_of(cases, axis, numbers, panel), {"case", "case"}};
    if (!axis.empty())
        axes.x = {axis, axis};
    if (numbers) {
        const auto number = [](const Plotted& row) { return std::get<double>(row.x); };
        const auto [first, last] = std::ranges::minmax_element(axes.rows, {}, number);
        const double least = number(*first), most = number(*last);
        axes.x = {axis, unit_of(cases, axis), least > 0 && most / least > 16};
    }
    return axes;
}

// A figure for a column of errors.
struct DrawnError {
    const char *figure, *title;
    study::FigureAxis y;
    std::string low{}, high{}; /* columns; empty: none */
};

// A table with the errors of each case, and figures of it.
void add_errors(study::StudyData& data, const Axes& axes, const char* table, const char* title,
                std::vector<study::ColumnOf<Plotted>> errors, const std::string& caption,
                const std::vector<DrawnError>& figures) {
    std::vector<study::ColumnOf<Plotted>> columns{{{"case", "", ""}, [](const Plotted& r) { return r.record->name; }}};
    if (!axes.axis.empty())
        columns.push_back({{axes.axis, axes.numbers ? "1" : "", ""}, &Plotted::x});
    if (!axes.panel.empty())
        columns.push_back({{axes.panel, "", ""}, &Plotted::panel});
    columns.push_back({{"series", "", "the other parameters"}, &Plotted::series});
    study::append(columns, std::move(errors));
    data.tables.push_back(study::table_of<Plotted>(table, title, columns, axes.rows));
    constexpr std::size_t kMostBars = 60;
    if (!axes.numbers && (axes.rows.size() < 2 || axes.rows.size() > kMostBars))
        return;
    const bool series =
        std::ranges::any_of(axes.rows, [](const Plotted& row) { return !row.series.empty(); }) && !axes.axis.empty();
    for (const DrawnError& one : figures)
        data.figures.push_back(
            study::make_figure(one.figure, fmt::format("{} over {}", one.title, axes.x.column), caption,
                               axes.numbers ? study::FigureKind::scatter : study::FigureKind::bars, table, {}, axes.x,
                               one.y, series ? "series" : "", "",
                               {.low = one.low, .high = one.high, .joined = axes.numbers, .panels = axes.panel}));
}

// The least and the largest of some numbers and of their draws; of one alone it and the range of its draws.
std::string range_text(std::vector<DrawnNumber> values, double factor, const char* unit) {
    std::erase_if(values, [](const DrawnNumber& one) { return std::isnan(one.value); }); // no place has a force
    if (values.empty())
        return "nowhere defined";
    constexpr double kNothing = 1e-5; // deg, 1 or N: rounding
    const auto text = [&](double value) { return number_text(std::abs(value) < kNothing ? 0 : factor * value, 2); };
    const std::string low = text(std::ranges::min(values, {}, &DrawnNumber::low).low),
                      high = text(std::ranges::max(values, {}, &DrawnNumber::high).high);
    return low == high          ? fmt::format("{} {}", low, unit)
           : values.size() == 1 ? fmt::format("{} ({} to {}) {}", text(values[0].value), low, high, unit)
                                : fmt::format("{} to {} {}", low, high, unit);
}

// Of all samples of a grid, which are not drawn.
DrawnNumber exact(double value) {
    return {value, value, value};
}

// The range of a number over the cases: "2 to 12 deg without shading and 0 deg with it" where both are among them.
template <typename Number>
std::string by_shading(const Rows& cases, const Number& number, double factor, const char* unit) {
    std::vector<DrawnNumber> all, plain, shaded;
    for (const CaseRecord* record : cases) {
        const DrawnNumber value = number(*record);
        all.push_back(value);
        if (const std::string shading = record->parameter("shading"); !shading.empty())
            (shading == "none" ? plain : shaded).push_back(value);
    }
    if (plain.empty() || shaded.empty())
        return range_text(all, factor, unit);
    return fmt::format("{} without shading and {} with it", range_text(plain, factor, unit),
                       range_text(shaded, factor, unit));
}

// The texts that `of` gives the cases, each once, in their order.
std::vector<std::string> distinct(const Rows& cases, std::string (*of)(R)) {
    std::vector<std::string> texts;
    for (R one : cases)
        if (std::ranges::find(texts, of(one)) == texts.end())
            texts.push_back(of(one));
    return texts;
}

// What the touched cases' forces are held against.
std::string touched_truth(const Rows& cases) {
    return fmt::format("{}", fmt::join(distinct(cases,
                                                [](R one) {
                                                    return one->touch->against +
                                                           (one->touch->against == kSmoothShape
                                                                ? " (its normal above the probe, which shading takes)"
                                                                : "");
                                                }),
                                       " or "));
}

// How deep the touched places are.
std::string touched_depths(const Rows& cases) {
    const auto [least, most] = std::ranges::minmax_element(cases, {}, [](R one) { return one->touch->deepest; });
    return fmt::format("{:.3g} to {:.3g} mm", 10 * (*least)->touch->deepest, 1e3 * (*most)->touch->deepest);
}

// Errors where a hand touches, in a sentence; empty without such errors.
std::string touch_finding(const Sweep& sweep) {
    const Rows cases = with_touch(sweep);
    if (cases.empty())
        return "";
    const CaseRecord& worst = **std::ranges::max_element(cases, {}, [](R one) { return one->touch->missed.value; });
    const double missed = worst.touch->missed.value;
    return fmt::format("Where a hand touches, {} deep, the force's direction is {} (RMS) from that of {}; the whole "
                       "force errs by {} (median; ranges are over {}{} draws of places).{}",
                       touched_depths(cases),
                       by_shading(
                           cases, [](const CaseRecord& one) { return one.touch->direction; }, 1, "deg"),
                       touched_truth(cases),
                       by_shading(
                           cases, [](const CaseRecord& one) { return one.touch->median_error; }, 100, "%"),
                       cases.size() > 1 ? "cases and " : "", worst.touch->draws,
                       missed < 0.01 ? ""
                                     : fmt::format(" Of {}, {} % of the places have no force.", worst.name,
                                                   number_text(100 * missed, missed < 0.99 ? 2 : 3)));
}

// How deep contact is at most that counts.
std::string depths_text(const Rows& cases) {
    return fmt::format(
        "{}",
        fmt::join(distinct(cases, [](R one) { return number_text(1e3 * one->deviation->depth, 3) + " mm"; }), " or "));
}

// What the cases are compared with: shapes, and where on them depth is read, whose numbers are not to be mixed.
std::vector<std::string> compared_with(const Rows& cases) {
    return distinct(cases, [](R one) { return one->deviation->from; });
}

// Of the comparison that the scenes ask for, a sentence for each shape; empty without one.
std::string compare_finding(const Sweep& sweep) {
    std::string text;
    for (const std::string& shape : compared_with(with_compare(sweep))) {
        Rows cases = with_compare(sweep);
        std::erase_if(cases, [&](R one) { return one->deviation->from != shape; });
        text += fmt::format(
            "{}Compared with {}, the force's direction differs by {}, its magnitude by {} (RMS, contact at most {} "
            "deep).",
            text.empty() ? "" : " ", shape,
            by_shading(
                cases, [](const CaseRecord& one) { return exact(one.deviation->rms_angle); }, 1, "deg"),
            by_shading(
                cases, [](const CaseRecord& one) { return exact(one.deviation->rms_magnitude_error); }, 1, "N"),
            depths_text(cases));
    }
    return text;
}

// mJ on the hand, the mean of a case's paths.
double work_of(const CaseRecord& one) {
    return 1e3 * one.paths->work / std::max(1.0, double(one.paths->paths));
}

} // namespace

void add_path_figures(const Sweep& sweep, study::StudyData& data) {
    const Rows cases = with_paths(sweep);
    if (cases.empty())
        return;
    using Row = const Plotted&;
    const auto compared = [](Row r) {
        const auto& deviation = r.record->paths->deviation;
        return deviation && deviation->angles > 0 ? study::Cell(deviation->rms_angle) : study::Cell();
    };
    const Axes axes = axes_of(cases);
    std::vector<DrawnError> figures{
        {"path-force", "Largest force along the paths", {"largest_force_N", "largest force / N"}},
        {"path-work", "Work on the hand along the paths", {"work_mJ", "work on the hand / mJ, mean of the paths"}}};
    if (std::ranges::all_of(axes.rows, [&](Row r) { return !compared(r).text().empty(); }))
        figures.insert(figures.begin(), {"path-angle",
                                         "Error of the force's direction along the paths",
                                         {"angle_deg", "RMS angle to the shape of [compare] / deg"}});
    add_errors(data, axes, "path_results", "What the paths meet",
               {{{"largest_force_N", "N", ""}, [](Row r) { return r.record->paths->largest_force; }},
                {{"work_mJ", "mJ", "on the hand, mean of the paths"}, [](Row r) { return work_of(*r.record); }},
                {{"mean_depth_mm", "mm", "in contact"}, [](Row r) { return 1e3 * r.record->paths->mean_depth; }},
                {{"unstable", "1", "paths that left their bound"}, [](Row r) { return r.record->paths->unstable; }},
                {{"angle_deg", "deg", "between the force and the normal of the shape of [compare], root mean square"},
                 compared}},
               "Over all paths of a case.", figures);
}

void add_compare_figures(const Sweep& sweep, study::StudyData& data) {
    const Rows cases = with_compare(sweep);
    if (cases.empty())
        return;
    using Row = const Plotted&;
    Axes axes = axes_of(cases);
    const std::vector<std::string> shapes = compared_with(cases);
    if (shapes.size() > 1) { // a panel each
        for (Plotted& row : axes.rows)
            row.panel = row.record->deviation->from + (row.panel.empty() ? "" : ", ") + row.panel;
        axes.panel = "compared with";
    }
    add_errors(data, axes, "compare", "Forces compared with the shape of [compare]",
               {{{"angle_deg", "deg", "between the force and the shape's normal, root mean square"},
                 [](Row r) { return r.record->deviation->rms_angle; }},
                {{"largest_angle_deg", "deg", ""}, [](Row r) { return r.record->deviation->largest_angle; }},
                {{"magnitude_N", "N", "|F| less K times the depth below the shape, root mean square"},
                 [](Row r) { return r.record->deviation->rms_magnitude_error; }},
                {{"largest_magnitude_N", "N", ""}, [](Row r) { return r.record->deviation->largest_magnitude_error; }},
                {{"samples", "1", "with a force"}, [](Row r) { return r.record->deviation->angles; }}},
               fmt::format("Compared with {}, at the samples whose contact is at most {} deep.",
                           fmt::join(shapes, ", or "), depths_text(cases)),
               {{"compare-angle", "Angle to the shape's normal", {"angle_deg", "RMS angle / deg"}},
                {"compare-magnitude", "Error of the magnitude", {"magnitude_N", "RMS error of |F| / N"}}});
}

void add_touch_figures(const Sweep& sweep, study::StudyData& data) {
    const Rows cases = with_touch(sweep);
    if (cases.empty())
        return;
    using Row = const Plotted&;
    add_errors(
        data, axes_of(cases), "touch", "Errors where a hand touches",
        {{{"direction_deg", "deg", "angle to the force that should be there, root mean square"},
          [](Row r) { return r.record->touch->direction.value; }},
         {{"direction_low_deg", "deg", "the least of the draws of places"},
          [](Row r) { return r.record->touch->direction.low; }},
         {{"direction_high_deg", "deg", "the largest of them"}, [](Row r) { return r.record->touch->direction.high; }},
         {{"force_percent", "%", "|F - F_true| / |F_true|, median"},
          [](Row r) { return 100 * r.record->touch->median_error.value; }},
         {{"force_low_percent", "%", "the least of the draws of places"},
          [](Row r) { return 100 * r.record->touch->median_error.low; }},
         {{"force_high_percent", "%", "the largest of them"},
          [](Row r) { return 100 * r.record->touch->median_error.high; }},
         {{"force_p95_percent", "%", "95th percentile"}, [](Row r) { return 100 * r.record->touch->p95_error.value; }},
         {{"missed_percent", "%", "of the places, those without the force that should be there"},
          [](Row r) { return 100 * r.record->touch->missed.value; }}},
        fmt::format("Against {}, at {} places anywhere on the surface, {} below it, log-uniform; spreads are those of "
                    "{} draws of places.",
                    touched_truth(cases), cases.front()->touch->places, touched_depths(cases),
                    cases.front()->touch->draws),
        {{"touch-direction",
          "Error of the force's direction",
          {"direction_deg", "RMS error of the direction / deg"},
          "direction_low_deg",
          "direction_high_deg"},
         {"touch-force",
          "Error of the force",
          {"force_percent", "median error of the force / % of the force there"},
          "force_low_percent",
          "force_high_percent"}});
}

namespace {

// The CPU engine is the oracle: compared with itself it says nothing.
bool is_oracle(R one) {
    return one->engine.engine == "cpu";
}

std::string agreement(Rows cases) {
    std::erase_if(cases, is_oracle);
    if (cases.empty())
        return "";
    const std::uint64_t compared = sum_of(cases, [](const CaseRecord& one) { return one.error.compared; });
    const std::uint64_t differing = sum_of(cases, [](const CaseRecord& one) { return one.error.differing; });
    const std::uint64_t beyond = sum_of(cases, [](const CaseRecord& one) { return one.error.beyond; });
    std::string text =
        fmt::format("Of {} voxels compared with the CPU oracle in the same precision, ", count_text(compared));
    if (compared == 0)
        return "No voxel was compared with the CPU oracle.";
    if (differing == 0)
        return text + "all are equal bit for bit.";
    text += fmt::format("{} differ{}", count_text(differing), differing == 1 ? "s" : "");
    return text + (beyond == 0
                       ? ", none by more than rounding allows."
                       : fmt::format(", {} of them by more than rounding allows: those volumes are not to be trusted.",
                                     count_text(beyond)));
}

std::string error(const Rows& cases) {
    const CaseRecord& worst =
        **std::ranges::max_element(cases, {}, [](const CaseRecord* one) { return one->error.relative(); });
    if (worst.error.relative() == 0)
        return "No force differs from the oracle in double precision.";
    return fmt::format(
        "The largest error against the oracle in double precision is {} of the case's largest force ({} N), in {}.",
        number_text(worst.error.relative(), 2), number_text(worst.error.largest, 2), worst.name);
}

std::string force(const Rows& cases) {
    const auto largest = [](const CaseRecord* one) { return one->largest_force; };
    const CaseRecord &most = **std::ranges::max_element(cases, {}, largest),
                     &least = **std::ranges::min_element(cases, {}, largest);
    if (most.largest_force == least.largest_force)
        return fmt::format("The largest force is {} N in every case.", number_text(most.largest_force, 3));
    return fmt::format("The largest force is {} N, in {}; the case whose largest is least, {}, reaches {} N.",
                       number_text(most.largest_force, 3), most.name, least.name, number_text(least.largest_force, 3));
}

std::string cost(const Rows& cases) {
    const auto kernel = [](const CaseRecord* one) { return one->engine_times.kernel; };
    const CaseRecord& dearest = **std::ranges::max_element(cases, {}, kernel);
    if (kernel(&dearest) <= 0)
        return "";
    return fmt::format("The dearest case took {} ms to compute, {}.", number_text(1e3 * kernel(&dearest), 3),
                       dearest.name);
}

std::string left_out(const Rows& cases) {
    const std::uint64_t voxels = sum_of(cases, &CaseRecord::voxels), evaluated = sum_of(cases, &CaseRecord::evaluated);
    if (evaluated >= voxels)
        return "";
    return fmt::format(
        "Only {} of {} voxels had to be evaluated ({} %); the others are {}.", count_text(evaluated),
        count_text(voxels), number_text(100 * static_cast<double>(evaluated) / static_cast<double>(voxels), 2),
        std::ranges::any_of(cases, [](R one) { return std::ranges::count(one->omitted, kFreeSpace) > 0; })
            ? "copies or free space"
            : "copies");
}

std::string paths(const Sweep& sweep) {
    const Rows cases = with_paths(sweep);
    const std::uint64_t count = sum_of(cases, [](const CaseRecord& one) { return one.paths->paths; });
    const std::uint64_t unstable = sum_of(cases, [](const CaseRecord& one) { return one.paths->unstable; });
    const std::uint64_t samples = sum_of(cases, [](const CaseRecord& one) { return one.paths->samples; });
    if (count == 0)
        return "";
    return fmt::format(
        "The largest force on a path is {}, the work on the hand per path {}. {} paths with {} samples were "
        "followed; {} left {} bound.",
        by_shading(
            cases, [](const CaseRecord& one) { return exact(one.paths->largest_force); }, 1, "N"),
        by_shading(
            cases, [](const CaseRecord& one) { return exact(work_of(one)); }, 1, "mJ"),
        count_text(count), count_text(samples), unstable == 0 ? "none" : count_text(unstable),
        unstable == 1 ? "its" : "their");
}

// Of a comparison with the oracle: empty for cases that it computed itself, and left out if it computed all.
Columns compared_columns(const Rows& rows, Columns columns) {
    if (std::ranges::all_of(rows, is_oracle))
        return {};
    for (auto& one : columns)
        one.value = [value = one.value](R r) { return is_oracle(r) ? study::Cell() : value(r); };
    return columns;
}

constexpr std::size_t kMostCases = 3000; // a page of more would not open

study::Table cases_table(const Sweep& sweep, const Rows& rows) {
    Columns columns{{"case", "", "", &CaseRecord::name}};
    std::vector<std::string> keys; // that vary within the sweep, in the order in which they come
    for (const CaseRecord& record : sweep.cases)
        for (const auto& [key, value] : record.parameters)
            if (std::ranges::find(keys, key) == keys.end())
                keys.push_back(key);
    for (const std::string& key : keys)
        columns.push_back({{key, "", ""}, [key](R r) {
                               const std::string value = r->parameter(key);
                               return value.empty() ? study::Cell() : study::Cell(value);
                           }});
    columns.insert(
        columns.end(),
        {{"precision", "", "", &CaseRecord::precision},
         {"voxels", "1", "of the grid", &CaseRecord::voxels},
         {"evaluated", "1", "voxels that had to be computed", &CaseRecord::evaluated},
         {"largest force", "N", "", &CaseRecord::largest_force},
         {"largest error", "N", "against the oracle in double precision", [](R r) { return r->error.largest; }},
         {"relative error", "1", "of the largest force", [](R r) { return r->error.relative(); }}});
    study::append(
        columns,
        compared_columns(rows, {{{"differing", "1", "voxels whose bits are not the oracle's in the same precision"},
                                 [](R r) { return r->error.differing; }},
                                {{"beyond bound", "1", "voxels further from the oracle than rounding allows"},
                                 [](R r) { return r->error.beyond; }}}));
    return study::table_of("cases", "Cases", columns, rows);
}

study::Table times_table(const Rows& rows) {
    Columns columns{{"case", "", "", &CaseRecord::name}};
    const auto add = [&](const char* name, const char* meaning, auto times, auto stage) {
        columns.push_back({{name, "ms", meaning}, [=](R r) { return 1e3 * r->*times.*stage; }});
    };
    const auto engine = &CaseRecord::engine_times;
    const auto files = &CaseRecord::volume_times;
    add("prepare", "images and meshes", engine, &EngineTimes::prepare);
    add("plan", "which voxels are visited", engine, &EngineTimes::plan);
    add("compile", "the kernel", engine, &EngineTimes::compile);
    add("upload", "", engine, &EngineTimes::upload);
    add("kernel", "", engine, &EngineTimes::kernel);
    add("read back", "from the device", engine, &EngineTimes::read_back);
    add("encode", "the volume", files, &VolumeTimings::encode);
    add("flush", "to disk", files, &VolumeTimings::flush);
    add("verify", "reading the volume back", files, &VolumeTimings::read_back);
    add("hash", "", files, &VolumeTimings::hash);
    add("check", "against the oracle", files, &VolumeTimings::check);
    return study::table_of("times", "Time by stage", columns, rows);
}

study::Table paths_table(const Rows& rows) {
    Columns columns{{"case", "", "", &CaseRecord::name},
                    {"paths", "1", "", [](R r) { return r->paths->paths; }},
                    {"samples", "1", "", [](R r) { return r->paths->samples; }},
                    {"in contact", "%", "of the samples",
                     [](R r) { return 100 * double(r->paths->in_contact) / std::max(1.0, double(r->paths->samples)); }},
                    {"unstable", "1", "paths that left their bound", [](R r) { return r->paths->unstable; }},
                    {"largest force", "N", "", [](R r) { return r->paths->largest_force; }},
                    {"work", "J", "on the hand, sum over the paths", [](R r) { return r->paths->work; }},
                    {"mean depth", "mm", "in contact", [](R r) { return 1e3 * r->paths->mean_depth; }}};
    study::append(columns, compared_columns(rows, {{{"compared", "1", "samples compared with the oracle"},
                                                    [](R r) { return r->paths->error.samples; }},
                                                   {{"differing", "1", "samples whose bits are not the oracle's"},
                                                    [](R r) { return r->paths->error.differing; }}}));
    columns.push_back({{"kernel", "ms", ""}, [](R r) { return 1e3 * r->paths->engine_times.kernel; }});
    return study::table_of("paths", "Paths", columns, rows);
}

// What the page draws of it.
study::StudyData tables_of(const Sweep& sweep) {
    Rows fields = with_field(sweep), paths = with_paths(sweep);
    for (Rows* const rows : {&fields, &paths})
        rows->resize(std::min(rows->size(), kMostCases));
    study::StudyData data;
    add_compare_figures(sweep, data);
    if (data.figures.empty())
        add_touch_figures(sweep, data);
    if (data.figures.empty())
        add_path_figures(sweep, data);
    if (!fields.empty()) {
        data.tables.push_back(cases_table(sweep, fields));
        data.tables.push_back(times_table(fields));
    }
    if (!paths.empty())
        data.tables.push_back(paths_table(paths));
    return data;
}

// Cases with the same list together, lists in the order in which they come.
std::string omitted_list(const Sweep& sweep) {
    struct Group {
        std::string list, names;
        std::size_t cases = 0;
    };
    std::vector<Group> groups;
    for (std::size_t i = 0; i < sweep.cases.size(); ++i) {
        const std::string list = fmt::format("{}", fmt::join(sweep.cases[i].omitted, ", "));
        auto found = std::ranges::find(groups, list, &Group::list);
        if (found == groups.end())
            found = groups.insert(groups.end(), {list, ""});
        found->names += (found->cases++ == 0 ? "" : ", ") + sweep.cases[i].name;
    }
    std::string html = "<dl class=\"meanings\">\n";
    for (const Group& group : groups) {
        const std::string cases = group.cases == sweep.cases.size() ? "all cases"
                                  : sweep.cases.size() > kMostCases ? count_text(group.cases) + " cases"
                                                                    : escaped(group.names);
        html += fmt::format("<dt>{}</dt><dd>{}</dd>\n", group.list.empty() ? "nothing" : escaped(group.list), cases);
    }
    return folded("What was left out, as no scene needed it", html + "</dl>\n");
}

} // namespace

std::vector<study::Finding> sweep_findings(const Sweep& sweep) {
    std::vector<study::Finding> findings;
    const auto add = [&](const char* name, const std::string& text) {
        if (!text.empty())
            findings.push_back({name, text});
    };
    add("compare", compare_finding(sweep));
    if (findings.empty())
        add("touch", touch_finding(sweep));
    if (const Rows cases = with_field(sweep); !cases.empty()) {
        add("agreement", agreement(cases));
        add("largest_error", error(cases));
        add("largest_force", force(cases));
        add("dearest_case", cost(cases));
        add("evaluated", left_out(cases));
    }
    add("paths", paths(sweep));
    return findings;
}

std::string sweep_section(const std::filesystem::path& root, const Sweep& sweep) {
    const std::string id = anchor(sweep);
    const std::span findings(sweep.findings);
    const std::size_t answers = std::min<std::size_t>(1, findings.size());
    std::string html = section_start(id, title(sweep), answers == 0 ? "" : findings_list(id, findings.first(answers)));
    if (findings.size() > answers)
        html += folded("How it was computed", findings_list(id, findings.subspan(answers)));
    html += facts({{"Program", sweep.program.empty() ? "" : "forceshade " + sweep.program},
                   {"Device", sweep.device},
                   {"Driver", sweep.driver},
                   {"Processor", sweep.cores ? fmt::format("{}, {} cores", sweep.cpu, sweep.cores) : sweep.cpu},
                   {"Cases", sweep.cases.size() == sweep.cases_of_study
                                 ? fmt::format("all {}", sweep.cases_of_study)
                                 : fmt::format("{} of {}; the same sweep without --only computes the rest",
                                               sweep.cases.size(), sweep.cases_of_study)},
                   {"Last run", sweep.seconds > 0 ? duration_text(sweep.seconds) : ""}});
    if (sweep.cases.empty())
        return html + "<p>This folder has no case that this program can read.</p>\n</section>\n";
    if (sweep.cases.size() > kMostCases)
        html += fmt::format("<p>Tables and files are those of the first {} of {} cases; summary.csv has all.</p>\n",
                            count_text(kMostCases), count_text(sweep.cases.size()));
    std::string files;
    for (const char* name : {"manifest.json", "summary.csv", "study.toml"})
        files += file_link(root, sweep.folder, name);
    for (const CaseRecord& record : std::span(sweep.cases).first(std::min(sweep.cases.size(), kMostCases)))
        for (const FileRecord& file : record.files)
            files += file_link(root, sweep.folder, file.name,
                               fmt::format(" <small>{}</small>", size_text(double(file.bytes))));
    return html + fmt::format("<div id=\"{}-data-tables\"></div>\n", id) + omitted_list(sweep) +
           folded("Files", "<ul class=\"files\">\n" + files + "</ul>\n") + page_data(id + "-data", tables_of(sweep)) +
           "</section>\n";
}

} // namespace forceshade::report
