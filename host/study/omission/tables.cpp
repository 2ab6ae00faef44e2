#include "host/study/omission/tables.h"

#include <algorithm>

#include "host/study/omission/unchanged.h"
#include "host/study/run/sampling.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

// Below this, medians may lie apart for reasons of their own: where buffers and code come to lie.
constexpr double kLeastEffect = 0.02;

std::vector<double> numbers(const Json& side, const char* key) {
    return side.at(key).get<std::vector<double>>();
}

Interval ratio_of_sides(const Json& result, const char* key) {
    std::vector<double> ratios;
    const std::vector<double> with = numbers(result.at("with"), key), without = numbers(result.at("without"), key);
    for (std::size_t i = 0; i < std::min(with.size(), without.size()); ++i)
        if (without[i] > 0)
            ratios.push_back(with[i] / without[i]);
    return bootstrap_median(ratios);
}

// How far the median lies from 1 where nothing was switched in the scene.
double floor_of(const std::string& scene, const char* key, const std::vector<Comparison>& comparisons,
                const std::vector<Json>& results) {
    double floor = kLeastEffect;
    for (std::size_t i = 0; i < comparisons.size(); ++i)
        if (comparisons[i].feature == kControl && comparisons[i].scene == scene) {
            const double control = ratio_of_sides(results[i], key).median;
            floor = std::max({floor, control - 1, 1 / control - 1});
        }
    return floor;
}

// "saves", "costs" or "within the spread".
std::string verdict(const Interval& ratio, double floor) {
    if (ratio.low > 1 && ratio.median >= 1 + floor)
        return "saves";
    if (ratio.high < 1 && ratio.median <= 1 / (1 + floor))
        return "costs";
    return "within the spread";
}

const std::vector<Column>& feature_columns() {
    static const std::vector<Column> columns{
        {"feature", "", "what is switched"},
        {"scene", "", "in which scene, everything else in it as it was"},
        {"with", "", "what is evaluated with it"},
        {"without", "", "what is evaluated without it"},
        {"omitted", "", "what the manifest calls it where it is left out; empty: the manifest does not tell of it"},
        {"manifest_agrees", "", "yes: the manifest tells of the omission where it is left out and not where it is not"},
        {"samples", "1", "samples of the grid, or of all paths"},
        {"kernel_ns_with", "ns", "kernel time a sample with it, median"},
        {"kernel_ns_with_q1", "ns", "its first quartile"},
        {"kernel_ns_with_q3", "ns", "its third quartile"},
        {"kernel_ns_without", "ns", "kernel time a sample without it, median"},
        {"kernel_ns_without_q1", "ns", "its first quartile"},
        {"kernel_ns_without_q3", "ns", "its third quartile"},
        {"kernel_ratio", "1", "kernel time with over without in the same round, median"},
        {"kernel_ratio_q1", "1", "its first quartile"},
        {"kernel_ratio_q3", "1", "its third quartile"},
        {"kernel_saved_percent", "%", "share of the kernel time that leaving it out saves, median; below 0 it costs"},
        {"kernel_saved_percent_q1", "%", "its first quartile"},
        {"kernel_saved_percent_q3", "%", "its third quartile"},
        {"kernel_verdict", "",
         "what leaving it out does to the kernel's time: saves or costs where the quartiles of the ratio are on one "
         "side of 1 and the median is further from it than 2 % and than that with nothing switched; control: nothing "
         "was switched"},
        {"whole_ns_with", "ns", "time a sample by the clock, planning and tables included, median"},
        {"whole_ns_without", "ns", "the same without it"},
        {"whole_ratio", "1", "time by the clock with over without in the same round, median"},
        {"whole_ratio_q1", "1", "its first quartile"},
        {"whole_ratio_q3", "1", "its third quartile"},
        {"whole_saved_percent", "%", "share of the time by the clock that leaving it out saves, median"},
        {"whole_saved_percent_q1", "%", "its first quartile"},
        {"whole_saved_percent_q3", "%", "its third quartile"},
        {"whole_verdict", "", "as kernel_verdict"},
        {"evaluated_with", "1", "samples that a kernel evaluated with it"},
        {"evaluated_without", "1", "samples that a kernel evaluated without it"},
        {"uploaded_with_bytes", "B", "tables, plans and positions copied to the device with it"},
        {"uploaded_without_bytes", "B", "the same without it"},
        {"received_with_bytes", "B", "results read back with it"},
        {"received_without_bytes", "B", "results read back without it"},
        {"bytes_ratio", "1", "bytes to and from the device, with over without"},
        {"bytes_saved_percent", "%", "share of these bytes that leaving it out saves"},
        {"file_with_bytes", "B", "the volume's file with it"},
        {"file_without_bytes", "B", "the volume's file without it"},
        {"file_ratio", "1", "size of the file, with over without"},
        {"same_forces", "",
         "yes: the forces without it are those with it, so that it may be left out; no: it is another law"},
        {"same", "", "what must be the same with and without it"},
        {"compared", "1", "samples compared"},
        {"in_contact", "1", "samples of them with a force"},
        {"differing", "1", "samples of them that are not the same"},
        {"largest_deviation", "1", "of magnitudes that must agree to rounding, relative; else empty"}};
    return columns;
}

Cell ratio_of(double with, double without) {
    return without > 0 ? cell(with / without) : Cell();
}

// Of what it takes with the feature, where that is so many times what it takes without.
double saved_percent(double ratio) {
    return 100 * (1 - 1 / ratio);
}

std::vector<Cell> feature_row(const Comparison& one, const Json& result, double kernel_floor, double whole_floor) {
    const Json &with = result.at("with"), &without = result.at("without");
    const double samples = with.at("samples").get<double>();
    std::vector<Cell> row{one.feature,      one.scene,   one.with.what,
                          one.without.what, one.omitted, std::string(agrees_with_manifest(one) ? "yes" : "no"),
                          cell(samples)};
    const auto add = [&](double value) { row.push_back(cell(value)); };
    const auto add_times = [&](const Json& side) {
        const Interval times = bootstrap_median(numbers(side, "kernel_s"));
        for (const double seconds : {times.median, times.low, times.high})
            add(1e9 * seconds / samples);
    };
    const auto add_ratios = [&](const char* key, double floor) {
        const Interval ratio = ratio_of_sides(result, key);
        for (const double value : {ratio.median, ratio.low, ratio.high})
            add(value);
        for (const double value : {ratio.median, ratio.low, ratio.high})
            add(saved_percent(value));
        row.push_back(one.feature == kControl ? "control" : verdict(ratio, floor));
    };
    add_times(with);
    add_times(without);
    add_ratios("kernel_s", kernel_floor);
    add(1e9 * quantile(numbers(with, "whole_s"), 0.5) / samples);
    add(1e9 * quantile(numbers(without, "whole_s"), 0.5) / samples);
    add_ratios("whole_s", whole_floor);
    const auto add_pair = [&](const char* key) {
        for (const Json* side : {&with, &without})
            row.push_back(side->contains(key) ? cell(side->at(key).get<double>()) : Cell());
    };
    add_pair("evaluated");
    add_pair("uploaded");
    add_pair("received");
    const auto moved = [](const Json& side) {
        return side.at("uploaded").get<double>() + side.at("received").get<double>();
    };
    row.push_back(ratio_of(moved(with), moved(without)));
    row.push_back(moved(with) > 0 ? cell(saved_percent(moved(with) / moved(without))) : Cell());
    add_pair("file");
    row.push_back(ratio_of(with.value("file", 0.0), without.value("file", 0.0)));
    row.push_back(std::string(same_forces(one) ? "yes" : "no"));
    row.push_back(what_is_compared(one));
    row.push_back(cell(result.at("compared").get<double>()));
    row.push_back(cell(result.at("in_contact").get<double>()));
    row.push_back(cell(result.at("differing").get<double>()));
    row.push_back(one.force == Agreement::magnitude ? cell(result.at("largest").get<double>()) : Cell());
    return row;
}

Figure bars(const Table& features, const char* name, const char* title, const char* column, const char* label) {
    Figure figure;
    figure.name = name;
    figure.title = title;
    figure.kind = FigureKind::bars;
    figure.table = features.name;
    figure.x = {"feature", "feature"};
    figure.y = {column, label};
    figure.series = "scene";
    return figure;
}

} // namespace

Table features_table(const std::vector<Comparison>& comparisons, const std::vector<Json>& results) {
    Table table{"features", "Each feature switched alone", feature_columns(), {}};
    for (std::size_t i = 0; i < comparisons.size(); ++i)
        table.rows.push_back(feature_row(comparisons[i], results[i],
                                         floor_of(comparisons[i].scene, "kernel_s", comparisons, results),
                                         floor_of(comparisons[i].scene, "whole_s", comparisons, results)));
    return table;
}

Table omitted_table(const std::vector<BaseScene>& scenes, const std::vector<Comparison>& comparisons) {
    Table table{"omitted",
                "What the manifests say was left out",
                {{"scene", "", "which scene"},
                 {"omitted", "", "as its manifest calls it"},
                 {"feature", "",
                  "the feature that measures what this saves there; not measured: none does; cannot be switched: such "
                  "surfaces never "
                  "have it"}},
                {}};
    for (const BaseScene& base : scenes)
        for (const std::string& phrase : omissions(base.prepared.one.scene)) {
            const auto measures = [&](const Comparison& one) {
                return one.scene == base.name && one.omitted == phrase;
            };
            const auto found = std::ranges::find_if(comparisons, measures);
            const bool cannot =
                phrase == "shading" && base.prepared.one.scene.surface.kind == SurfaceKind::cylinder_bump;
            table.rows.push_back({base.name, phrase,
                                  found != comparisons.end() ? found->feature
                                  : cannot                   ? std::string("cannot be switched")
                                                             : std::string("not measured")});
        }
    return table;
}

std::vector<Figure> omission_figures(const Table& features) {
    Figure kernel = bars(features, "kernel", "What leaving a feature out saves of the kernel's time",
                         "kernel_saved_percent", "kernel time saved / %");
    kernel.low = "kernel_saved_percent_q1";
    kernel.high = "kernel_saved_percent_q3";
    kernel.caption =
        "Each bar is the share of the kernel time with a feature that is saved without it, everything else "
        "as it was: 50 % is half the time, 0 nothing, below 0 it takes longer without. Whiskers are "
        "quartiles; \"nothing\" is a control, in which both sides are the same.";
    Figure whole = bars(features, "whole", "What leaving a feature out saves by the clock", "whole_saved_percent",
                        "time saved / %");
    whole.low = "whole_saved_percent_q1";
    whole.high = "whole_saved_percent_q3";
    whole.caption = "The same for everything between a scene's tables and its results in memory: planning, uploads, "
                    "kernel, checks. What the host does for a feature shows here and not in the kernel's time.";
    Figure moved = bars(features, "bytes", "What leaving a feature out saves of the bytes", "bytes_saved_percent",
                        "bytes to and from the device saved / %");
    moved.caption = "Tables, plans and results that travel to the device and back: the share that is saved without a "
                    "feature. A channel costs its share of the results whatever its kernel takes.";
    return {kernel, whole, moved};
}

} // namespace forceshade::study
