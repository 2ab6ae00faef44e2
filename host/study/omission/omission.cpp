#include "host/study/omission/omission.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"

namespace forceshade::study {
namespace {

using Row = Measurement;
using Ratio = Interval (Row::*)() const;
using Columns = std::vector<ColumnOf<Row>>;

Interval ratio_of(const std::vector<double>& with, const std::vector<double>& without) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i)
        if (without[i] > 0)
            ratios.push_back(with[i] / without[i]);
    return bootstrap_median(ratios);
}

// The ratio of the control, in that scene.
Interval control_of(const std::vector<Row>& rows, const std::string& scene, Ratio ratio) {
    for (const Row& row : rows)
        if (row.comparison.scene == scene && row.comparison.feature == kControl)
            return (row.*ratio)();
    return {1, 1, 1};
}

// Whether it takes significantly longer with the feature: beyond the control.
bool costs(const std::vector<Row>& rows, const Row& row, Ratio ratio) {
    const Interval control = control_of(rows, row.comparison.scene, ratio);
    return !was_busy(control) && (row.*ratio)().low > std::max(1.0, control.high);
}

std::string what_is_same(const Row& row) {
    if (row.agreement.differing > 0)
        return fmt::format("no: {} of {} differ", row.agreement.differing, row.agreement.compared);
    const Same same = row.comparison.same;
    return same == Same::bits     ? "forces, bit for bit"
           : same == Same::values ? "forces, as numbers"
                                  : "metrics of each path, bit for bit";
}

double saved_percent(double ratio) {
    return 100 * (1 - 1 / ratio);
}

// A number of each side, in columns NAME with {} for "with" and "without".
template <typename Of>
void add_sides(Columns& columns, const char* name, const char* unit, const std::string& meaning, Of of) {
    columns.push_back({{fmt::format(fmt::runtime(name), "with"), unit, meaning + " with it"},
                       [of](const Row& r) { return Cell(of(r.with)); }});
    columns.push_back({{fmt::format(fmt::runtime(name), "without"), unit, "the same without it"},
                       [of](const Row& r) { return Cell(of(r.without)); }});
}

void add_ratio(Columns& columns, const std::string& kind, const char* of, Ratio ratio) {
    const auto add = [&](const char* name, const char* unit, const std::string& meaning, double Interval::*end) {
        const bool share = unit == std::string_view("%");
        columns.push_back({{kind + name, unit, meaning}, [=](const Row& r) {
                               const double times = (r.*ratio)().*end;
                               return share ? saved_percent(times) : times;
                           }});
    };
    add("_ratio", "1", fmt::format("{} with it over that without it, in the same round: median", of),
        &Interval::median);
    add("_ratio_from", "1", "95 % interval of that (bootstrap)", &Interval::low);
    add("_ratio_to", "1", "the other end", &Interval::high);
    add("_saved_percent", "%", "share of the time saved by leaving it out: median", &Interval::median);
    add("_saved_from_percent", "%", "95 % interval of that (bootstrap)", &Interval::low);
    add("_saved_to_percent", "%", "the other end", &Interval::high);
}

Table feature_table(const std::vector<Row>& rows) {
    const auto per_sample = [](std::vector<double> MeasuredSide::*seconds) {
        return [=](const MeasuredSide& side) {
            return 1e9 * quantile(side.*seconds, 0.5) / static_cast<double>(side.samples);
        };
    };
    Columns columns{
        {"feature", "", "the switched feature, all else equal; nothing: a control, both sides alike",
         [](const Row& r) { return r.comparison.feature; }},
        {"scene", "", "in which scene", [](const Row& r) { return r.comparison.scene; }},
        {"with", "", "evaluated with it", [](const Row& r) { return r.comparison.with.what; }},
        {"without", "", "evaluated without it", [](const Row& r) { return r.comparison.without.what; }},
        {"left_out_by", "", "program: always left out, no scene can request it; scene: a scene may request it",
         [](const Row& r) { return r.comparison.always ? "program" : "scene"; }},
        {"same", "", "equal on both sides", what_is_same},
        {"same_forces", "", "yes: every force was the same without it",
         [](const Row& r) { return r.same_forces() ? "yes" : "no"; }},
        {"samples", "1", "samples of the grid, or of all paths", [](const Row& r) { return r.with.samples; }}};
    add_sides(columns, "kernel_ns_{}", "ns", "median kernel time a sample", per_sample(&MeasuredSide::kernel));
    add_sides(columns, "whole_ns_{}", "ns",
              "time a sample of the whole evaluation (planning, uploads, kernel, reading back)",
              per_sample(&MeasuredSide::whole));
    const auto add_time = [&](const char* kind, const char* of, Ratio ratio) {
        add_ratio(columns, kind, of, ratio);
        columns.push_back(
            {{fmt::format("{}_costs", kind), "",
              "yes: its interval lies above 1 and above that of the control, \"nothing\", which is within 0.8 to 1.25"},
             [&rows, ratio](const Row& r) { return costs(rows, r, ratio) ? "yes" : "no"; }});
    };
    add_time("kernel", "kernel time", &Row::kernel_ratio);
    add_time("whole", "time of the whole evaluation", &Row::whole_ratio);
    add_sides(columns, "evaluated_{}", "1", "samples that a kernel evaluated",
              [](const MeasuredSide& side) { return side.cost.evaluated; });
    add_sides(columns, "moved_{}_bytes", "B", "tables, plans, positions and results copied to and from the device",
              [](const MeasuredSide& side) { return side.cost.uploaded + side.cost.received; });
    add_sides(columns, "file_{}_bytes", "B", "the volume's file",
              [](const MeasuredSide& side) { return side.file ? Cell(side.file) : Cell(); });
    columns.insert(
        columns.end(),
        {{"compared", "1",
          "samples compared, of the scene as it is and in three rounds; of paths that write none: paths",
          [](const Row& r) { return r.agreement.compared; }},
         {"in_contact", "1", "samples of them with a force", [](const Row& r) { return r.agreement.in_contact; }},
         {"differing", "1", "of those compared", [](const Row& r) { return r.agreement.differing; }},
         {"omitted", "", "its name in the manifest if it is left out",
          [](const Row& r) { return r.comparison.omitted; }},
         {"manifest_agrees", "", "yes: the manifest lists it if and only if it is left out",
          [](const Row& r) { return agrees_with_manifest(r.comparison) ? "yes" : "no"; }}});
    return table_of<Row>("features", "Features that do not change the forces, each switched alone", columns, rows);
}

Table omitted_table(const std::vector<BaseScene>& scenes, const std::vector<Row>& rows) {
    struct Phrase {
        std::string scene, omitted, measured;
    };
    std::vector<Phrase> phrases;
    for (const BaseScene& base : scenes)
        for (const std::string& omitted : omissions(base.prepared.one.scene)) {
            const auto found = std::ranges::find_if(rows, [&](const Row& row) {
                return row.comparison.scene == base.name && row.comparison.omitted == omitted;
            });
            phrases.push_back(
                {base.name, omitted, found != rows.end() ? found->comparison.feature : "another force: not compared"});
        }
    return table_of<Phrase>("omitted", "Omissions in the manifests",
                            {{"scene", "", "which scene", &Phrase::scene},
                             {"omitted", "", "its name in the manifest", &Phrase::omitted},
                             {"feature", "", "the feature that measures its saving", &Phrase::measured}},
                            phrases);
}

Figure bars(const std::string& kind, const char* title, const char* caption, const char* label) {
    return make_figure(kind, title, caption, FigureKind::bars, "features", {{kind + "_costs", "yes"}},
                       {"feature", "left out"}, {kind + "_ratio", label, true}, "scene", "",
                       {.low = kind + "_ratio_from", .high = kind + "_ratio_to"});
}

std::string name_of(const Row& row) {
    return fmt::format("{} ({})", row.comparison.feature, row.comparison.scene);
}

// "takes 15 [14, 17] times as long", "takes 12 [9.1, 15] % longer".
std::string longer(const Interval& ratio) {
    const bool times = ratio.median >= 1.5;
    const auto number = [&](double value) {
        return fmt::format(fmt::runtime(value >= 10 || (!times && value >= 1.1) ? "{:.0f}" : "{:.2g}"),
                           times ? value : 100 * (value - 1));
    };
    return fmt::format("{} [{}, {}] {}", number(ratio.median), number(ratio.low), number(ratio.high),
                       times ? "times as long" : "% longer");
}

std::string interval_of(const std::vector<Row>& rows, const Row& row) {
    const Interval whole = row.whole_ratio(), control = control_of(rows, row.comparison.scene, &Row::whole_ratio);
    return fmt::format(
        "{}: {:.3g} to {:.3g} times; control {:.3g} to {:.3g} (95 % of bootstrap medians of {} paired rounds)",
        name_of(row), whole.low, whole.high, control.low, control.high, row.with.whole.size());
}

const char* const kCondition = "forces bit for bit or number for number the same on every sample; whole evaluation: "
                               "planning, uploads, kernel, reading back";

void add_findings(std::vector<Finding>& findings, const std::vector<Row>& rows) {
    std::vector<const Row*> program, scene, file;
    for (const Row& row : rows) {
        if (!row.same_forces())
            continue;
        if (row.with.file > row.without.file)
            file.push_back(&row);
        if (row.comparison.feature == kControl)
            continue;
        if (costs(rows, row, &Row::whole_ratio))
            (row.comparison.always ? program : scene).push_back(&row);
    }
    const auto listed = [](std::vector<const Row*>& some) {
        std::ranges::stable_sort(some, {}, [](const Row* row) { return -row->whole_ratio().median; });
        std::vector<std::string> parts;
        for (std::size_t i = 0; i < std::min<std::size_t>(some.size(), 2); ++i)
            parts.push_back(fmt::format("{} with {}", longer(some[i]->whole_ratio()), name_of(*some[i])));
        return fmt::format("{}", fmt::join(parts, ", "));
    };
    if (!program.empty()) {
        const std::string list = listed(program);
        findings.push_back(
            {"program", fmt::format("Computing what is always skipped would make the whole evaluation take {}.", list),
             "whole", name_of(*program.front()), kCondition, interval_of(rows, *program.front())});
    }
    if (!scene.empty()) {
        const std::string list = listed(scene);
        const Row& first = *scene.front();
        findings.push_back(
            {"scene",
             fmt::format("What a scene need not ask for costs time where it does: the whole evaluation takes "
                         "{}; the kernel alone {} with {}.",
                         list,
                         costs(rows, first, &Row::kernel_ratio) ? longer(first.kernel_ratio())
                                                                : "not significantly longer",
                         name_of(first)),
             "whole", name_of(first), kCondition, interval_of(rows, first)});
    }
    const auto file_ratio = [](const Row* row) { return double(row->with.file) / double(row->without.file); };
    if (const auto largest = std::ranges::max_element(file, {}, file_ratio); largest != file.end())
        findings.push_back({"file",
                            fmt::format("The volume's file is {:.2g} times as large with the {}.", file_ratio(*largest),
                                        name_of(**largest)),
                            "", name_of(**largest), "as a sweep writes it, compressed", ""});
}

constexpr Rounds kFull{15, 0.1, 6}, kQuick{9, 0.02, 1};

// In a scene without contact all forces are zero: no omission could change a force, and all times would be those of
// free space.
void require_contact(const BaseScene& base, const Touched& samples) {
    if (samples.field == 0 && samples.paths == 0)
        throw UsageError("no sample of the scene's {} is in contact; move it below the surface",
                         !base.paths  ? "[grid]"
                         : base.field ? "[grid] and [paths]"
                                      : "[paths]");
}

// If only the grid or only the paths have samples in contact.
void add_free_note(const BaseScene& base, const Touched& samples, StudyData& data) {
    for (const auto& [what, free] :
         {std::pair("[grid]", base.field && samples.field == 0), {"[paths]", base.paths && samples.paths == 0}})
        if (free)
            data.notes.push_back(
                fmt::format("No sample of the scene's {} is in contact: its results are those of free space.", what));
}

void add_notes(const std::vector<BaseScene>& scenes, const Rounds& rounds, StudyData& data) {
    for (const BaseScene& base : scenes) {
        const auto& size = base.prepared.one.scene.grid.size;
        data.notes.push_back(
            base.field ? fmt::format("{}: {}, {} x {} x {} voxels.", base.name, base.about, size[0], size[1], size[2])
                       : fmt::format("{}: {}.", base.name, base.about));
    }
    data.notes.push_back(
        fmt::format("Each ratio is of {} paired rounds, fewer where they take long. In each the grid is moved at "
                    "random by up to half its spacing and a mesh turned, or paths are drawn anew; both sides are "
                    "evaluated in turn, each "
                    "first as often, repeatedly if that takes only a moment, and the least times count.",
                    rounds.count));
    data.notes.push_back("Every y and free space are always left out where a scene permits; the study alone evaluates "
                         "them. Outputs that depend on y (proxies) are switched at every y on both sides.");
}

} // namespace

Interval Measurement::kernel_ratio() const {
    return ratio_of(with.kernel, without.kernel);
}

Interval Measurement::whole_ratio() const {
    return ratio_of(with.whole, without.whole);
}

void add_omissions(StudyData& data, const std::vector<BaseScene>& scenes, const std::vector<Measurement>& rows) {
    data.tables = {feature_table(rows), omitted_table(scenes, rows)};
    data.figures = {bars("whole", "What is left out would cost this: time of the whole evaluation",
                         "Time with a feature over that without it; whiskers are 95 % intervals. Only what costs more "
                         "than the control, two sides that are alike; the table has the others.",
                         "time with it / time without it"),
                    bars("kernel", "What is left out would cost this: time of the kernel",
                         "The same for the kernel alone, without the host's work for a feature.",
                         "kernel time with it / without it")};
    std::erase_if(data.figures, [&](const Figure& figure) { // without a bar
        const Table& features = data.tables.front();
        for (std::size_t row = 0; row < features.rows.size(); ++row)
            if (features.word(row, figure.name + "_costs") == "yes")
                return false;
        return true;
    });
    add_findings(data.findings, rows);
    for (const Row& row : rows)
        if (const Interval control = row.whole_ratio(); row.comparison.feature == kControl && was_busy(control))
            data.notes.push_back(
                fmt::format("{}: of two equal sides one took {:.2g} to {:.2g} times as long as the other, so busy was "
                            "the machine: no cost is drawn or found in this scene; run the study again.",
                            row.comparison.scene, control.low, control.high));
}

StudyData study_omission(StudyRun& run) {
    const Rounds rounds = run.options().quick ? kQuick : kFull;
    const std::vector<BaseScene> scenes =
        run.scene() ? std::vector{user_scene(*run.scene(), run.options().quick)} : own_scenes(run.options().quick);
    Touched samples;
    std::vector<Measurement> rows;
    std::vector<Part> parts;
    if (run.scene())
        parts.push_back({"contact", [&] {
                             samples = touched(run.engine(), scenes.front());
                             require_contact(scenes.front(), samples);
                         }});
    for (const BaseScene& base : scenes)
        for (Comparison& one : comparisons_of(base, !run.options().engine.cpu))
            parts.push_back({fmt::format("{}: {}", one.scene, one.feature), [&run, &rows, rounds, one] {
                                 rows.push_back(measure(run.engine(), one, rounds, run.options().folder));
                             }});
    run.run(parts);
    StudyData data = run.data();
    add_omissions(data, scenes, rows);
    add_notes(scenes, rounds, data);
    if (run.scene())
        add_free_note(scenes.front(), samples, data);
    return data;
}

} // namespace forceshade::study
