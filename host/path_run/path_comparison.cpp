#include "host/path_run/path_comparison.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/interrupt.h"
#include "host/paths/recorded_file.h"
#include "host/paths/scene_paths.h"

namespace forceshade {
namespace {

constexpr layout::uint kEverything = layout::kChannelForce | layout::kChannelPosition | layout::kChannelDepth |
                                     layout::kChannelFacet | layout::kChannelProxy;

template <typename T> PathError compare_in(Engine& engine, const PreparedCase& prepared) {
    const PathsSpec& spec = *prepared.one.scene.paths;
    const bool recorded = spec.kind == PathKind::recorded;
    const std::shared_ptr<const RecordedFile> file = recorded ? read_recorded<T>(prepared, spec.path) : nullptr;
    ScenePaths<T> paths(prepared, file), alike(prepared, file);
    layout::PathInput<T> input = paths.input(), same = alike.input();
    input.features.channels = same.features.channels = kEverything;
    for (ScenePaths<T>* each : {&paths, &alike})
        each->limit_batches(samples_that_fit(input));
    BatchedSource<T> source(paths, input.steps, paths_that_fit(input));
    input.source = &source;
    PathOracle<T> oracle(prepared, same, engine.report().software, 0);
    RowGatherer<T> gatherer(source, [&](const PathRows<T>& rows) { oracle.compare(rows); });
    engine.explore(
        input,
        [&](const layout::PathChunk<T>& chunk) {
            check_interrupt();
            gatherer.add(chunk);
        },
        [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { oracle.compare(first, metrics); });
    if (file)
        file->require_unchanged();
    return oracle.error();
}

const char* name_of(Precision precision) {
    return precision == Precision::f32 ? "f32" : "f64";
}

} // namespace

PathComparison compare_paths(Engine& engine, const PreparedCase& prepared, Precision precision) {
    PathComparison comparison{prepared.one.name, precision, {}, false};
    comparison.error =
        precision == Precision::f32 ? compare_in<float>(engine, prepared) : compare_in<double>(engine, prepared);
    comparison.passed = comparison.error.passed();
    return comparison;
}

PathTotals totals_of(const std::vector<PathComparison>& comparisons) {
    PathTotals totals;
    for (const PathComparison& one : comparisons) {
        totals.samples += one.error.samples;
        totals.differing += one.error.differing;
        totals.passed = totals.passed && one.passed;
    }
    return totals;
}

std::string path_comparison_table(const std::vector<PathComparison>& comparisons) {
    std::size_t width = 4;
    for (const PathComparison& one : comparisons)
        width = std::max(width, one.name.size());
    std::string text = fmt::format("{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11}  {:>11}  {}\n", "case", width,
                                   "", "paths", "samples", "bits", "metrics", "max |F|", "against", "");
    text += fmt::format("{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11}  {:>11}  {}\n", "", width, "", "", "",
                        "differ", "differ", "N", "oracle / N", "");
    for (const PathComparison& one : comparisons)
        text += fmt::format("{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11.4g}  {:>11.2e}  {}\n", one.name, width,
                            name_of(one.precision), one.error.paths, one.error.samples, one.error.differing,
                            one.error.metrics, one.error.largest_force, one.error.largest,
                            one.passed ? "ok" : "FAILED: " + one.error.first);
    return text;
}

std::string path_comparison_json(const std::vector<PathComparison>& comparisons) {
    nlohmann::ordered_json json = nlohmann::ordered_json::array();
    for (const PathComparison& one : comparisons)
        json.push_back({{"case", one.name},
                        {"precision", name_of(one.precision)},
                        {"paths", one.error.paths},
                        {"samples", one.error.samples},
                        {"differing", one.error.differing},
                        {"metrics_differing", one.error.metrics},
                        {"beyond_bound", one.error.beyond},
                        {"largest_error_N", one.error.largest},
                        {"largest_force_N", one.error.largest_force},
                        {"passed", one.passed},
                        {"first_difference", one.error.first}});
    return json.dump(2);
}

} // namespace forceshade
