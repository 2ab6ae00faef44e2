#include "host/study/omission/results.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/data/rows.h"

namespace forceshade::study {
namespace {

using Row = OmissionRow;

Interval ratio_of(const std::vector<double>& with, const std::vector<double>& without) {
    std::vector<double> ratios;
    for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i)
        if (without[i] > 0)
            ratios.push_back(with[i] / without[i]);
    return bootstrap_median(ratios);
}

// What the measurement itself makes of nothing, in that scene.
Interval control_of(const std::vector<Row>& rows, const std::string& scene, Interval (Row::*ratio)() const) {
    for (const Row& row : rows)
        if (row.comparison.scene == scene && row.comparison.feature == kControl)
            return (row.*ratio)();
    return {1, 1, 1};
}

// Whether it takes longer with it for sure: beyond what nothing makes.
bool costs(const std::vector<Row>& rows, const Row& row, Interval (Row::*ratio)() const) {
    return (row.*ratio)().low > std::max(1.0, control_of(rows, row.comparison.scene, ratio).high);
}

std::string what_is_same(const Row& row) {
    const Agreement& agreement = row.measured.agreement;
    if (agreement.differing > 0)
        return fmt::format("no: {} of {} differ", agreement.differing, agreement.compared);
    switch (row.comparison.same) {
    case Same::bits:
        return "forces, bit for bit";
    case Same::values:
        return "forces, as numbers";
    case Same::metrics:
        break;
    }
    return "what each path adds up to, bit for bit";
}

double saved_percent(double ratio) {
    return 100 * (1 - 1 / ratio);
}

Table feature_table(const std::vector<Row>& rows) {
    const auto per_sample = [](const std::vector<double>& seconds, const MeasuredSide& side) {
        return cell(1e9 * quantile(seconds, 0.5) / static_cast<double>(side.samples));
    };
    const auto bytes = [](std::uint64_t count) { return cell(static_cast<double>(count)); };
    std::vector<ColumnOf<Row>> columns{
        {{"feature", "", "what is switched, everything else as it was; nothing: a control, both sides alike"},
         [](const Row& r) { return Cell(r.comparison.feature); }},
        {{"scene", "", "in which scene"}, [](const Row& r) { return Cell(r.comparison.scene); }},
        {{"with", "", "what is evaluated with it"}, [](const Row& r) { return Cell(r.comparison.with.what); }},
        {{"without", "", "what is evaluated without it"}, [](const Row& r) { return Cell(r.comparison.without.what); }},
        {{"left_out_by", "", "program: always left out, no scene can ask for it; scene: a scene may ask for it"},
         [](const Row& r) { return Cell(r.comparison.always ? "program" : "scene"); }},
        {{"same", "", "what was the same on both sides"}, [](const Row& r) { return Cell(what_is_same(r)); }},
        {{"same_forces", "", "yes: every force was the same without it"},
         [](const Row& r) { return Cell(r.same_forces() ? "yes" : "no"); }},
        {{"samples", "1", "samples of the grid, or of all paths"},
         [](const Row& r) { return cell(double(r.measured.with.samples)); }},
        {{"kernel_ns_with", "ns", "kernel time a sample with it, median"},
         [=](const Row& r) { return per_sample(r.measured.with.kernel, r.measured.with); }},
        {{"kernel_ns_without", "ns", "likewise without it"},
         [=](const Row& r) { return per_sample(r.measured.without.kernel, r.measured.without); }},
        {{"whole_ns_with", "ns", "time a sample of the whole evaluation: planning, uploads, kernel, reading back"},
         [=](const Row& r) { return per_sample(r.measured.with.whole, r.measured.with); }},
        {{"whole_ns_without", "ns", "likewise without it"},
         [=](const Row& r) { return per_sample(r.measured.without.whole, r.measured.without); }}};
    const auto add_ratio = [&](const std::string& kind, const char* of, Interval (Row::*ratio)() const) {
        const std::string what = std::string(of) + " with it over that without it, in the same round";
        std::ranges::move(
            std::vector<ColumnOf<Row>>{
                {{kind + "_ratio", "1", what + ": median"}, [=](const Row& r) { return cell((r.*ratio)().median); }},
                {{kind + "_ratio_from", "1", "95 % interval of that (bootstrap)"},
                 [=](const Row& r) { return cell((r.*ratio)().low); }},
                {{kind + "_ratio_to", "1", "likewise"}, [=](const Row& r) { return cell((r.*ratio)().high); }},
                {{kind + "_saved_percent", "%", "share of the time that leaving it out saves: median"},
                 [=](const Row& r) { return cell(saved_percent((r.*ratio)().median)); }},
                {{kind + "_saved_from_percent", "%", "95 % interval of that (bootstrap)"},
                 [=](const Row& r) { return cell(saved_percent((r.*ratio)().low)); }},
                {{kind + "_saved_to_percent", "%", "likewise"},
                 [=](const Row& r) { return cell(saved_percent((r.*ratio)().high)); }}},
            std::back_inserter(columns));
    };
    add_ratio("kernel", "kernel time", &Row::kernel_ratio);
    add_ratio("whole", "time of the whole evaluation", &Row::whole_ratio);
    std::ranges::move(
        std::vector<ColumnOf<Row>>{
            {{"evaluated_with", "1", "samples that a kernel evaluated with it"},
             [=](const Row& r) { return bytes(r.measured.with.cost.evaluated); }},
            {{"evaluated_without", "1", "likewise without it"},
             [=](const Row& r) { return bytes(r.measured.without.cost.evaluated); }},
            {{"moved_with_bytes", "B", "tables, plans, positions and results copied to and from the device with it"},
             [=](const Row& r) { return bytes(r.measured.with.cost.uploaded + r.measured.with.cost.received); }},
            {{"moved_without_bytes", "B", "likewise without it"},
             [=](const Row& r) { return bytes(r.measured.without.cost.uploaded + r.measured.without.cost.received); }},
            {{"file_with_bytes", "B", "the volume's file with it"},
             [=](const Row& r) { return r.measured.with.file ? bytes(r.measured.with.file) : Cell(); }},
            {{"file_without_bytes", "B", "likewise without it"},
             [=](const Row& r) { return r.measured.without.file ? bytes(r.measured.without.file) : Cell(); }},
            {{"compared", "1", "samples compared, of paths that write none: paths"},
             [=](const Row& r) { return bytes(r.measured.agreement.compared); }},
            {{"in_contact", "1", "samples of them with a force"},
             [=](const Row& r) { return bytes(r.measured.agreement.in_contact); }},
            {{"differing", "1", "of those compared"},
             [=](const Row& r) { return bytes(r.measured.agreement.differing); }},
            {{"omitted", "", "what the manifest calls it where it is left out"},
             [](const Row& r) { return Cell(r.comparison.omitted); }},
            {{"manifest_agrees", "", "yes: the manifest tells of it where it is left out and not where it is not"},
             [](const Row& r) { return Cell(agrees_with_manifest(r.comparison) ? "yes" : "no"); }}},
        std::back_inserter(columns));
    return table_of<Row>("features", "Each thing that the same forces may do without, switched alone", columns, rows);
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
    return table_of<Phrase>(
        "omitted", "What the manifests say was left out",
        {{{"scene", "", "which scene"}, [](const Phrase& one) { return Cell(one.scene); }},
         {{"omitted", "", "as its manifest calls it"}, [](const Phrase& one) { return Cell(one.omitted); }},
         {{"feature", "", "what measures here what it saves"}, [](const Phrase& one) { return Cell(one.measured); }}},
        phrases);
}

Figure bars(const std::string& kind, const char* title, const char* caption, const char* label) {
    Figure figure;
    figure.name = kind;
    figure.title = title;
    figure.caption = caption;
    figure.kind = FigureKind::bars;
    figure.table = "features";
    figure.x = {"feature", "left out", false};
    figure.y = {kind + "_saved_percent", label, false};
    figure.series = "scene";
    figure.low = kind + "_saved_from_percent";
    figure.high = kind + "_saved_to_percent";
    return figure;
}

std::string name_of(const Row& row) {
    return fmt::format("{} ({})", row.comparison.feature, row.comparison.scene);
}

// "takes 15 times as long", "takes 12 % longer".
std::string longer(double ratio) {
    return ratio >= 2 ? fmt::format("{:.2g} times as long", ratio) : fmt::format("{:.2g} % longer", 100 * (ratio - 1));
}

std::string interval_of(const std::vector<Row>& rows, const Row& row) {
    const Interval whole = row.whole_ratio(), control = control_of(rows, row.comparison.scene, &Row::whole_ratio);
    return fmt::format(
        "{}: {:.3g} to {:.3g} times; with nothing switched {:.3g} to {:.3g} (95 % of bootstrap medians of {} "
        "paired rounds)",
        name_of(row), whole.low, whole.high, control.low, control.high, row.measured.with.whole.size());
}

// Those that cost time for sure, the dearest first.
std::vector<const Row*> dear(const std::vector<Row>& rows, bool always) {
    std::vector<const Row*> some;
    for (const Row& row : rows)
        if (row.comparison.feature != kControl && row.same_forces() && row.comparison.always == always &&
            costs(rows, row, &Row::whole_ratio))
            some.push_back(&row);
    std::ranges::stable_sort(some, {}, [](const Row* row) { return -row->whole_ratio().median; });
    return some;
}

std::string listed(const std::vector<const Row*>& some, std::size_t most) {
    std::vector<std::string> parts;
    for (const Row* row : some)
        if (parts.size() < most)
            parts.push_back(fmt::format("{} with {}", longer(row->whole_ratio().median), name_of(*row)));
    return fmt::format("{}", fmt::join(parts, ", "));
}

const char* const kCondition = "forces bit for bit or number for number the same on every sample; whole evaluation: "
                               "planning, uploads, kernel, reading back";

void add_findings(std::vector<Finding>& findings, const std::vector<Row>& rows) {
    const std::vector<const Row*> program = dear(rows, true), scene = dear(rows, false);
    if (!program.empty())
        findings.push_back({"program",
                            fmt::format("What the program always leaves out would make the whole evaluation take {}.",
                                        listed(program, 3)),
                            "whole", name_of(*program.front()), kCondition, interval_of(rows, *program.front())});
    if (!scene.empty()) {
        const Row& first = *scene.front();
        findings.push_back({"scene",
                            fmt::format("A scene that asks for what changes no force pays for it: the whole evaluation "
                                        "takes {}; the kernel alone {:.3g} times as long with {}.",
                                        listed(scene, 3), first.kernel_ratio().median, name_of(first)),
                            "whole", name_of(first), kCondition, interval_of(rows, first)});
    }
    const Row* file = nullptr;
    const auto ratio = [](const Row& row) {
        return row.measured.without.file ? double(row.measured.with.file) / double(row.measured.without.file) : 0;
    };
    for (const Row& row : rows)
        if (row.same_forces() && ratio(row) > std::max(1.0, file ? ratio(*file) : 0))
            file = &row;
    if (file)
        findings.push_back(
            {"file",
             fmt::format("The volume's file is {:.2g} times as large with the {}.", ratio(*file), name_of(*file)), "",
             name_of(*file), "as a sweep writes it, compressed", ""});
    std::vector<std::string> free;
    for (const Row& row : rows)
        if (row.comparison.feature != kControl && row.same_forces() && !costs(rows, row, &Row::kernel_ratio) &&
            !costs(rows, row, &Row::whole_ratio))
            free.push_back(name_of(row));
    if (!free.empty())
        findings.push_back(
            {"free", fmt::format("These cost no time that the rounds tell from nothing: {}.", fmt::join(free, ", ")),
             "kernel", "", kCondition, ""});
}

} // namespace

Interval OmissionRow::kernel_ratio() const {
    return ratio_of(measured.with.kernel, measured.without.kernel);
}

Interval OmissionRow::whole_ratio() const {
    return ratio_of(measured.with.whole, measured.without.whole);
}

void add_omissions(StudyData& data, const std::vector<BaseScene>& scenes, const std::vector<OmissionRow>& rows) {
    data.tables = {feature_table(rows), omitted_table(scenes, rows)};
    data.figures = {
        bars("whole", "What leaving things out saves of the whole evaluation",
             "Share of the time with a thing that is saved without it; whiskers are 95 % intervals. \"nothing\" is a "
             "control: both sides are alike.",
             "time saved / %"),
        bars("kernel", "What leaving things out saves of the kernel's time",
             "Likewise of the kernel alone; what the host does for a thing shows above and not here.",
             "kernel time saved / %")};
    add_findings(data.findings, rows);
}

} // namespace forceshade::study
