#include "host/paths/path_comparison.h"

#include <algorithm>
#include <memory>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/paths/recorded.h"
#include "host/paths/scene_paths.h"
#include "host/program.h"

namespace forceshade {

namespace {

constexpr layout::uint kEverything = layout::kChannelForce | layout::kChannelPosition | layout::kChannelDepth |
                                     layout::kChannelFacet | layout::kChannelProxy;

template <typename T> void compare_in(Engine& engine, const PreparedCase& prepared, PathComparison& comparison) {
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
    ProxySides<T> sides(prepared, std::uint64_t(input.paths) * input.steps, input.features.loop == layout::kLoopClosed);
    RowGatherer<T> gatherer(source, [&](const PathRows<T>& rows) {
        oracle.compare(rows);
        sides.check(rows);
    });
    engine.explore(
        input,
        [&](const layout::PathChunk<T>& chunk) {
            check_interrupt();
            gatherer.add(chunk);
        },
        [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) { oracle.compare(first, metrics); });
    if (file)
        file->require_unchanged();
    comparison.error = oracle.error();
    comparison.sides = sides.count();
}

const char* name_of(Precision precision) {
    return precision == Precision::f32 ? "f32" : "f64";
}

const std::string& first_of(const PathComparison& one) {
    return one.error.first.empty() ? one.sides.first : one.error.first;
}

} // namespace

PathComparison compare_paths(Engine& engine, const PreparedCase& prepared, Precision precision) {
    PathComparison comparison{prepared.one.name, precision, {}, {}, false};
    if (precision == Precision::f32)
        compare_in<float>(engine, prepared, comparison);
    else
        compare_in<double>(engine, prepared, comparison);
    comparison.passed = comparison.error.passed() && comparison.sides.other == 0;
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
    std::string text = fmt::format("{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11}  {:>11}  {:>8}  {}\n", "case",
                                   width, "", "paths", "samples", "bits", "metrics", "max |F|", "against", "other", "");
    text += fmt::format("{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11}  {:>11}  {:>8}  {}\n", "", width, "", "",
                        "", "differ", "differ", "N", "oracle / N", "side", "");
    SideCount all;
    for (const PathComparison& one : comparisons) {
        text += fmt::format("{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11.4g}  {:>11.2e}  {:>8}  {}\n", one.name,
                            width, name_of(one.precision), one.error.paths, one.error.samples, one.error.differing,
                            one.error.metrics, one.error.largest_force, one.error.largest,
                            one.sides.closed ? fmt::format("{}", one.sides.other) : "-",
                            one.passed ? "ok" : "FAILED: " + first_of(one));
        all.closed = all.closed || one.sides.closed;
        all.samples += one.sides.samples;
        all.brute += one.sides.brute;
        all.near += one.sides.near;
    }
    if (all.closed)
        text +=
            fmt::format("other side: samples whose proxy is not on the side of a closed mesh where its path began, "
                        "by the winding number at {} samples, at {} of them by loops over all triangles; {} were too "
                        "near to the surface to tell\n",
                        all.samples, all.brute, all.near);
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
                        {"sides_told", one.sides.samples - one.sides.near},
                        {"sides_told_by_loops", one.sides.brute},
                        {"on_other_side", one.sides.other},
                        {"passed", one.passed},
                        {"first_difference", first_of(one)}});
    return json.dump(2);
}

} // namespace forceshade
