// Scores as tables, figures and findings, and for the terminal.
#include <algorithm>
#include <cmath>
#include <functional>
#include <tuple>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/numbers.h"
#include "host/score/score.h"

namespace forceshade::score {
namespace {

using study::Cell;
using study::FigureKind;
using study::Interval;

constexpr std::size_t kMostShown = 2000; // samples of a renderer in a figure

// A measure in a reader's unit.
struct Measure {
    const char* name; /* of columns, with its unit */
    const char* unit;
    double scale; /* that unit in one SI unit */
    double StrokeScore::*value;
    const char* meaning;
    enum Over { median, largest, sum } over = median; /* strokes */
};
constexpr const char* kOver[] = {"median over strokes", "largest of all strokes", "over all strokes"};

const std::vector<Measure>& measures() {
    using S = StrokeScore;
    static const std::vector<Measure> all{
        {"error_rms_N", "N", 1, &S::error_rms, "size of the difference from the oracle's force, root mean square"},
        {"error_p95_N", "N", 1, &S::error_p95, "the same, 95th percentile"},
        {"error_largest_N", "N", 1, &S::error_largest, "the same, the largest", Measure::largest},
        {"error_percent", "%", 100, &S::error_share, "its root mean square over that of the oracle's force"},
        {"magnitude_rms_N", "N", 1, &S::magnitude_rms, "difference of the forces' sizes, root mean square"},
        {"direction_rms_deg", "deg", 1, &S::direction_rms, "angle from the oracle's force, root mean square"},
        {"direction_p95_deg", "deg", 1, &S::direction_p95, "the same, 95th percentile"},
        {"smooth_direction_deg", "deg", 1, &S::smooth_direction,
         "angle from the normal of the shape of [compare], root mean square"},
        {"smooth_magnitude_N", "N", 1, &S::smooth_magnitude,
         "difference from the size of that shape's force, root mean square"},
        {"phantom_percent", "%", 100, &S::phantom_share, "samples with a force where the oracle has no contact",
         Measure::largest},
        {"phantom_largest_N", "N", 1, &S::phantom_largest, "the largest force there", Measure::largest},
        {"drop_outs", "1", 1, &S::drop_outs, "times that the force is lost in a contact and comes back", Measure::sum},
        {"pop_throughs", "1", 1, &S::pop_throughs,
         "times that the force turns to the other side, or is lost for the rest of the contact", Measure::sum},
        {"jumps_per_mm", "1/mm", 1, &S::jumps,
         "steps of the force of more than twice the stiffness times the step of the probe and 0.1 % of the stroke's "
         "largest force, over the way in contact"},
        {"above_30Hz_mN", "mN", 1e3, &S::buzz_30, "of the force above 30 Hz, root mean square"},
        {"above_100Hz_mN", "mN", 1e3, &S::buzz_100, "of the force above 100 Hz, root mean square"},
        {"added_30Hz_mN", "mN", 1e3, &S::added_30, "of the difference from the oracle's force above 30 Hz"},
        {"added_100Hz_mN", "mN", 1e3, &S::added_100, "of the difference from the oracle's force above 100 Hz"},
        {"work_mJ", "mJ", 1e3, &S::work, "work on the hand"},
        {"excess_work_mJ", "mJ", 1e3, &S::excess_work, "work on the hand beyond the oracle's"},
        {"loop_work_mJ", "mJ", 1e3, &S::loop_work,
         "work on the hand in strokes that end where they began: above 0 the surface gives energy", Measure::largest},
        {"proxy_inside_um", "um", 1e6, &S::inside, "how deep the renderer's proxy is below the surface, at most",
         Measure::largest},
        {"delay_ms", "ms", 1e3, &S::delay, "by which its forces come after the oracle's; below 0: before"},
        {"not_finite", "1", 1, &S::not_finite,
         "samples whose force is NaN, infinite or beyond 1e100 N: left out of errors, lost for faults; with one there "
         "is no spectrum, work and delay",
         Measure::sum},
    };
    return all;
}

std::vector<double> values_of(const Scored& scored, const Measure& measure) {
    std::vector<double> values;
    for (const StrokeScore& stroke : scored.strokes)
        if (const double value = measure.scale * stroke.*measure.value; std::isfinite(value))
            values.push_back(value);
    return values;
}

double sum_of(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values)
        sum += value;
    return sum;
}

struct MeasureRow {
    const Scored* scored;
    const Measure* measure;
    std::vector<double> values;
    Interval interval; /* of the median over strokes */
};

study::Table measures_table(const std::vector<Scored>& all) {
    std::vector<MeasureRow> rows;
    for (const Scored& scored : all)
        for (const Measure& measure : measures())
            if (std::vector<double> values = values_of(scored, measure); !values.empty())
                rows.push_back({&scored, &measure, values, study::bootstrap_median(values)});
    using R = MeasureRow;
    const auto interval = [](double Interval::*end) {
        return [end](const R& r) { return r.values.size() > 1 ? Cell(r.interval.*end) : Cell(); };
    };
    return study::table_of<R>(
        "measures", "Every measure of every renderer, over strokes",
        {{{"renderer", "", "whose forces"}, [](const R& r) { return r.scored->name; }},
         {{"measure", "", "what is measured, with its unit"}, [](const R& r) { return r.measure->name; }},
         {{"median", "", "over strokes, in the measure's unit"},
          [](const R& r) { return study::quantile(r.values, 0.5); }},
         {{"low", "", "95 % of the medians of bootstrap samples over strokes lie above"}, interval(&Interval::low)},
         {{"high", "", "and below"}, interval(&Interval::high)},
         {{"largest", "", "of a stroke"}, [](const R& r) { return *std::ranges::max_element(r.values); }},
         {{"total", "", "over all strokes, of what is counted"},
          [](const R& r) { return r.measure->over == Measure::sum ? Cell(sum_of(r.values)) : Cell(); }},
         {{"strokes", "1", "that have it"}, [](const R& r) { return r.values.size(); }},
         {{"meaning", "", "of the measure"}, [](const R& r) { return r.measure->meaning; }}},
        rows);
}

std::vector<study::ColumnOf<Scored>> time_columns() {
    using R = Scored;
    const auto nano = [](double UpdateTimes::*time) {
        return [time](const R& r) { return r.times ? Cell(1e9 * (*r.times).*time) : Cell(); };
    };
    return {{{"warm_ns", "ns", "an update in a second run along all strokes, mean"}, nano(&UpdateTimes::warm)},
            {{"p50_ns", "ns", "an update in the first run, median"}, nano(&UpdateTimes::median)},
            {{"p99_9_ns", "ns", "the same, once in a thousand"}, nano(&UpdateTimes::p999)},
            {{"worst_ns", "ns", "the same, the worst"}, nano(&UpdateTimes::worst)},
            {{"cold_ns", "ns", "with caches full of other memory, median"}, nano(&UpdateTimes::cold)},
            {{"boundary_ns", "ns",
              "what the way to the renderer's process and back takes, median; in none of the other times"},
             nano(&UpdateTimes::boundary)}};
}

std::vector<study::ColumnOf<Scored>> score_columns() {
    using R = Scored;
    std::vector<study::ColumnOf<R>> columns{
        {{"renderer", "", "whose forces"}, [](const R& r) { return r.name; }},
        {{"kind", "", "oracle; forceshade: another law of this program; renderer: a library; recorded: a file"},
         [](const R& r) { return r.kind; }},
        {{"status", "", "ok, or what it did wrong"}, [](const R& r) { return r.failed.empty() ? "ok" : r.failed; }}};
    for (const Measure& measure : measures())
        columns.push_back({{measure.name, measure.unit, fmt::format("{}, {}", measure.meaning, kOver[measure.over])},
                           [of = measure.value](const R& r) { return over_strokes(r, of); }});
    study::append(columns, time_columns());
    return columns;
}

study::Table renderers_table(const std::vector<Scored>& all) {
    return study::table_of<Scored>("renderers", "Renderers along the strokes", score_columns(), all);
}

// The same for each scene of a course.
study::Table scenes_table(const std::vector<SceneScores>& scenes) {
    study::Table table{"scenes", "Renderers in each scene", {{"scene", "", "of the course"}}, {}};
    for (const study::ColumnOf<Scored>& one : score_columns())
        table.columns.push_back(one.column);
    for (const SceneScores& scene : scenes)
        for (const Scored& scored : scene.scores.all) {
            std::vector<Cell>& cells = table.rows.emplace_back();
            cells.push_back(scene.name);
            for (const study::ColumnOf<Scored>& one : score_columns())
                cells.push_back(one.value(scored));
        }
    return table;
}

// "needle, " of a course's stroke.
std::string scene_of(const Stroke& stroke) {
    return stroke.scene.empty() ? "" : stroke.scene + ", ";
}

struct StrokeRow {
    const Scored* scored;
    const Stroke* stroke;
    const StrokeScore* score;
};

study::Table strokes_table(const std::vector<Scored>& all, const Strokes& strokes) {
    std::vector<StrokeRow> rows;
    for (const Scored& scored : all)
        for (std::size_t i = 0; i < scored.strokes.size(); ++i)
            rows.push_back({&scored, &strokes.all[i], &scored.strokes[i]});
    using R = StrokeRow;
    std::vector<study::ColumnOf<R>> columns{
        {{"renderer", "", "whose forces"}, [](const R& r) { return r.scored->name; }},
        {{"scene", "", "of a course"}, [](const R& r) { return r.stroke->scene; }},
        {{"path", "1", "the stroke, as its file numbers it"}, [](const R& r) { return r.stroke->id; }},
        {{"samples", "1", "of the stroke"}, [](const R& r) { return r.stroke->probe.size(); }}};
    for (const Measure& measure : measures())
        columns.push_back({{measure.name, measure.unit, measure.meaning},
                           [&measure](const R& r) { return measure.scale * r.score->*measure.value; }});
    return study::table_of<R>("strokes", "Every stroke of every renderer", columns, rows);
}

struct FaultRow {
    const Scored* scored;
    const Stroke* stroke;
    Fault fault;
};

study::Table faults_table(const std::vector<Scored>& all, const Strokes& strokes) {
    std::vector<FaultRow> rows;
    for (const Scored& scored : all)
        for (std::size_t i = 0; i < scored.strokes.size(); ++i)
            for (const Fault& fault : scored.strokes[i].faults)
                rows.push_back({&scored, &strokes.all[i], fault});
    using R = FaultRow;
    const auto place = [](int axis) {
        return [axis](const R& r) { return 1e3 * r.stroke->probe[r.fault.sample][axis]; };
    };
    return study::table_of<R>(
        "faults", "Contacts that are lost",
        {{{"renderer", "", "whose forces"}, [](const R& r) { return r.scored->name; }},
         {{"fault", "",
           "pop-through: the force turns to the other side or does not come back; drop-out: it comes back"},
          [](const R& r) { return r.fault.through ? "pop-through" : "drop-out"; }},
         {{"scene", "", "of a course"}, [](const R& r) { return r.stroke->scene; }},
         {{"path", "1", "the stroke"}, [](const R& r) { return r.stroke->id; }},
         {{"t_s", "s", "when it begins"}, [](const R& r) { return r.stroke->time[r.fault.sample]; }},
         {{"duration_ms", "ms", "from its first to its last sample"}, [](const R& r) { return 1e3 * r.fault.seconds; }},
         {{"x_mm", "mm", "where"}, place(0)},
         {{"y_mm", "mm", "where"}, place(1)},
         {{"z_mm", "mm", "where"}, place(2)}},
        rows);
}

// The stroke at which renderers and oracle differ most, but for those with forces beyond all measure.
std::size_t telling_stroke(const std::vector<Scored>& all) {
    std::size_t stroke = 0;
    double most = -1;
    for (const Scored& scored : all)
        for (std::size_t i = 0; i < scored.strokes.size(); ++i)
            if (const double share = scored.strokes[i].error_share;
                std::isfinite(share) && std::min(share, 2.0) > most) {
                most = std::min(share, 2.0);
                stroke = i;
            }
    return stroke;
}

struct SignalRow {
    const Scored* scored;
    double time;
    glm::dvec3 force, difference; /* N */
};

study::Table signals_table(const std::vector<Scored>& all, const Strokes& strokes, std::size_t stroke) {
    const Stroke& one = strokes.all[stroke];
    const std::size_t step = one.probe.size() / kMostShown + 1;
    std::vector<SignalRow> rows;
    for (const Scored& scored : all)
        for (std::size_t i = 0; !scored.track.empty() && i < one.probe.size(); i += step)
            rows.push_back({&scored, one.time[i], scored.track[stroke][i],
                            scored.track[stroke][i] - all.front().track[stroke][i]});
    using R = SignalRow;
    return study::table_of<R>("signals", fmt::format("Forces along {}path {}", scene_of(one), one.id),
                              {{{"renderer", "", "whose forces"}, [](const R& r) { return r.scored->name; }},
                               {{"t_s", "s", "of the sample"}, [](const R& r) { return r.time; }},
                               {{"force_N", "N", "size of the force"}, [](const R& r) { return glm::length(r.force); }},
                               {{"fx_N", "N", "along x"}, [](const R& r) { return r.force.x; }},
                               {{"fy_N", "N", "along y"}, [](const R& r) { return r.force.y; }},
                               {{"fz_N", "N", "along z"}, [](const R& r) { return r.force.z; }},
                               {{"difference_N", "N", "size of the difference from the oracle's force"},
                                [](const R& r) { return glm::length(r.difference); }}},
                              rows);
}

study::Finding finding_of(const Scored& scored, std::size_t index) {
    using S = StrokeScore;
    const auto value = [&](double S::*of) { return over_strokes(scored, of); };
    study::Finding finding;
    finding.name = fmt::format("renderer_{}", index);
    finding.figure = "errors";
    if (!scored.failed.empty()) {
        finding.text = fmt::format("{} {}; it has no score.", scored.name, scored.failed);
        return finding;
    }
    if (!std::isfinite(value(&S::error_rms))) {
        finding.text = fmt::format("{}: no sample has a finite force; it has no score.", scored.name);
        return finding;
    }
    finding.text = fmt::format("{}: its forces differ from the oracle's by {:.3g} % of their root mean square",
                               scored.name, value(&S::error_share));
    if (const double angle = value(&S::direction_rms); std::isfinite(angle))
        finding.text += fmt::format(", by {:.3g} deg in direction", angle);
    finding.text += fmt::format("; {} and {}", numbers::counted(std::uint64_t(value(&S::pop_throughs)), "pop-through"),
                                numbers::counted(std::uint64_t(value(&S::drop_outs)), "drop-out"));
    if (const double buzz = value(&S::added_100); std::isfinite(buzz))
        finding.text += fmt::format("; above 100 Hz {:.3g} mN that the oracle does not have", buzz);
    if (const double phantom = value(&S::phantom_largest); phantom > 0)
        finding.text += fmt::format("; up to {:.3g} N without contact", phantom);
    if (const double count = value(&S::not_finite); count > 0)
        finding.text += fmt::format("; {} without a finite force", numbers::counted(std::uint64_t(count), "sample"));
    if (scored.times)
        finding.text += fmt::format("; an update takes {} ({} once in a thousand)",
                                    numbers::quantity_text(scored.times->median, "s"),
                                    numbers::quantity_text(scored.times->p999, "s"));
    finding.text += ".";
    const std::vector<double> shares =
        values_of(scored, *std::ranges::find(measures(), &S::error_share, &Measure::value));
    if (shares.size() > 1) {
        const Interval interval = study::bootstrap_median(shares);
        finding.interval = fmt::format("median over {} strokes; 95 % of bootstrap samples: {:.3g} to {:.3g} %",
                                       shares.size(), interval.low, interval.high);
    }
    return finding;
}

} // namespace

double over_strokes(const Scored& scored, double StrokeScore::*of) {
    const Measure& measure = *std::ranges::find(measures(), of, &Measure::value);
    const std::vector<double> values = values_of(scored, measure);
    if (values.empty())
        return NAN;
    return measure.over == Measure::sum       ? sum_of(values)
           : measure.over == Measure::largest ? *std::ranges::max_element(values)
                                              : study::quantile(values, 0.5);
}

std::vector<std::pair<std::string, double>> named_measures(const StrokeScore& score) {
    std::vector<std::pair<std::string, double>> named;
    for (const Measure& measure : measures())
        named.emplace_back(measure.name, measure.scale * score.*measure.value);
    return named;
}

void add_scores(study::StudyData& data, const Scores& scores, const Strokes& strokes,
                const std::vector<SceneScores>& scenes) {
    const std::vector<Scored>& scored = scores.all;
    const std::size_t shown = telling_stroke(scored);
    for (const std::string& warning : scores.warnings)
        data.notes.push_back(warning);
    data.notes.push_back(
        fmt::format("{} of {}. The oracle is this program's god-object in double precision with the scene's shading; "
                    "every renderer gets the same positions, whatever its forces would have done to a hand. A contact "
                    "counts from 5 % of a stroke's largest force on.",
                    numbers::counted(strokes.all.size(), "stroke"), numbers::counted(strokes.samples(), "sample")));
    data.notes.push_back("A library runs in a process of its own; its times are taken there, around each update, and "
                         "hold no way between processes. Intervals are of bootstrap samples over strokes.");
    data.tables.push_back(renderers_table(scored));
    if (!scenes.empty())
        data.tables.push_back(scenes_table(scenes));
    data.tables.push_back(measures_table(scored));
    data.tables.push_back(strokes_table(scored, strokes));
    if (study::Table faults = faults_table(scored, strokes); !faults.rows.empty())
        data.tables.push_back(std::move(faults));
    data.tables.push_back(signals_table(scored, strokes, shown));
    study::Figure front =
        study::make_figure("front", "Error against run time",
                           "Each mark is a renderer: how long an update takes, median of the first run, and how far "
                           "its forces are from the oracle's. The oracle itself has no error, and no mark.",
                           FigureKind::scatter, "renderers", {}, {"p50_ns", "time of an update / ns", true},
                           {"error_percent", "RMS error / % of the RMS force", true}, "renderer", "renderer");
    data.figures.push_back(std::move(front));
    study::Figure errors =
        study::make_figure("errors", "Difference from the oracle's force",
                           "The median over strokes of the root mean square difference, over the root mean square of "
                           "the oracle's force; the spread is of bootstrap samples over strokes.",
                           FigureKind::bars, "measures", {{"measure", "error_percent"}}, {"renderer", "renderer"},
                           {"median", "RMS error / % of the RMS force"});
    errors.low = "low";
    errors.high = "high";
    data.figures.push_back(std::move(errors));
    if (!scenes.empty())
        data.figures.push_back(study::make_figure(
            "scenes", "Difference from the oracle's force, scene by scene", "The same for the strokes of each scene.",
            FigureKind::bars, "scenes", {}, {"scene", "scene"},
            {"error_percent", "RMS error / % of the RMS force", true}, "renderer"));
    study::Figure buzz = study::make_figure(
        "buzz", "Vibration that the oracle does not have",
        "Root mean square of the difference from the oracle's force above 100 Hz, where skin feels best.",
        FigureKind::bars, "measures", {{"measure", "added_100Hz_mN"}}, {"renderer", "renderer"},
        {"median", "above 100 Hz / mN"});
    buzz.low = "low";
    buzz.high = "high";
    const auto has_spectrum = [](const Scored& one) {
        return std::isfinite(over_strokes(one, &StrokeScore::added_100));
    };
    if (std::ranges::any_of(scored, has_spectrum))
        data.figures.push_back(std::move(buzz));
    for (const auto& [name, title, column, label] :
         {std::tuple("differences", "Difference from the oracle", "difference_N", "difference / N"),
          std::tuple("signals", "Force along z", "fz_N", "force along z / N")}) {
        study::Figure signal = study::make_figure(
            name, fmt::format("{}, {}path {}", title, scene_of(strokes.all[shown]), strokes.all[shown].id),
            "The stroke at which a renderer differs most from the oracle.", FigureKind::scatter, "signals", {},
            {"t_s", "time / s"}, {column, label}, "renderer");
        signal.joined = true;
        data.figures.push_back(std::move(signal));
    }
    for (const bool own : {false, true})                // what is measured comes first
        for (std::size_t i = 1; i < scored.size(); ++i) // but for the oracle's own
            if (own == (scored[i].kind == "oracle" || scored[i].kind == "forceshade"))
                data.findings.push_back(finding_of(scored[i], i));
}

std::string score_text(const Scores& scores) {
    using S = StrokeScore;
    const std::vector<Scored>& scored = scores.all;
    std::size_t width = 8;
    for (const Scored& one : scored)
        width = std::max(width, one.name.size());
    constexpr const char* kRow = "{:<{}}  {:>9}  {:>9}  {:>8}  {:>8}  {:>7}  {:>9}  {:>8}  {:>6}  {:>9}  {:>9}\n";
    std::string text = fmt::format(fmt::runtime(kRow), "renderer", width, "error", "direction", "phantom", "pop-",
                                   "drop-", "jumps", "added", "NaN", "update", "99.9 %");
    text += fmt::format(fmt::runtime(kRow), "", width, "% RMS", "deg RMS", "N", "throughs", "outs", "1/mm", ">100 Hz",
                        "", "us", "us");
    for (const Scored& one : scored) {
        if (!one.failed.empty()) {
            text += fmt::format("{:<{}}  {}\n", one.name, width, one.failed);
            continue;
        }
        const auto shown = [](double value) { return std::isfinite(value) ? fmt::format("{:.3g}", value) : "-"; };
        const auto value = [&](double S::*of) { return shown(over_strokes(one, of)); };
        const auto count = [&](double S::*of) { return fmt::format("{:.0f}", over_strokes(one, of)); };
        text +=
            fmt::format(fmt::runtime(kRow), one.name, width, value(&S::error_share), value(&S::direction_rms),
                        value(&S::phantom_largest), count(&S::pop_throughs), count(&S::drop_outs), value(&S::jumps),
                        value(&S::added_100), count(&S::not_finite), shown(one.times ? 1e6 * one.times->median : NAN),
                        shown(one.times ? 1e6 * one.times->p999 : NAN));
    }
    text += "error, direction, jumps and mN of vibration that the oracle does not have: median over strokes; phantom: "
            "the largest; faults and NaN: all of them; update: median, and once in a thousand\n";
    if (std::ranges::any_of(scored, [](const Scored& one) { return over_strokes(one, &S::not_finite) > 0; }))
        text += "a stroke with NaN has no spectrum, work and delay, and is not in their medians\n";
    return text;
}

} // namespace forceshade::score
