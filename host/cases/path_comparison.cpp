#include "host/cases/path_comparison.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "host/long_run.h"
#include "host/paths/recorded.h"
#include "host/program.h"
#include "host/referee/validate.h"

namespace forceshade {
namespace {

template <typename T> void compare_in(Engine& engine, const PreparedCase& prepared, PathComparison& comparison) {
    const PathsSpec& spec = *prepared.one.scene.paths;
    const bool recorded = spec.kind == PathKind::recorded;
    const std::shared_ptr<const RecordedFile> file = recorded ? read_recorded<T>(prepared, spec.path) : nullptr;
    EngineAndOracle<T> both(prepared, file, kSampled, engine.report().software, 0);
    ContactReferee<T> contacts(prepared, std::uint64_t(both.input.paths) * both.input.steps,
                               both.input.features.loop == layout::kLoopClosed);
    RowGatherer<T> gatherer(both.source, [&](const PathRows<T>& rows) {
        both.oracle.compare(rows);
        contacts.check(rows);
    });
    engine.explore(
        both.input,
        [&](const layout::PathChunk<T>& chunk) {
            check_interrupt();
            gatherer.add(chunk);
        },
        [&](std::size_t first, std::span<const layout::PathMetrics<T>> metrics) {
            both.oracle.compare(first, metrics);
        });
    if (file)
        file->require_unchanged();
    comparison.error = both.oracle.error();
    comparison.contacts = contacts.count();
}

const std::string& first_of(const PathComparison& one) {
    return one.error.first.empty() ? one.contacts.first : one.error.first;
}

} // namespace

PathComparison compare_paths(Engine& engine, const PreparedCase& prepared, Precision precision) {
    PathComparison comparison{prepared.one.name, precision, {}, {}, false};
    in_precision(precision, [&]<typename T>(std::type_identity<T>) { compare_in<T>(engine, prepared, comparison); });
    comparison.passed = comparison.error.passed() && comparison.contacts.wrong() == 0;
    return comparison;
}

std::string path_comparison_table(const std::vector<PathComparison>& comparisons) {
    std::size_t width = 4;
    for (const PathComparison& one : comparisons)
        width = std::max(width, one.name.size());
    constexpr const char* kRow =
        "{:<{}}  {:>4}  {:>8}  {:>10}  {:>8}  {:>8}  {:>11}  {:>11}  {:>7}  {:>10}  {:>8}  {:>8}  {:>8}  {}\n";
    std::string text = fmt::format(fmt::runtime(kRow), "case", width, "", "paths", "samples", "bits", "metrics",
                                   "max |F|", "against", "grew", "unbalanced", "drop-out", "phantom", "other", "");
    text += fmt::format(fmt::runtime(kRow), "", width, "", "", "", "differ", "differ", "N", "oracle / N", "", "", "",
                        "", "side", "");
    ContactCount all;
    for (const PathComparison& one : comparisons) {
        const ContactCount& contacts = one.contacts;
        const auto shown = [](std::uint64_t count, bool looked_at) {
            return looked_at ? fmt::format("{}", count) : "-";
        };
        text += fmt::format(fmt::runtime(kRow), one.name, width, name_of(one.precision), one.error.paths,
                            one.error.samples, one.error.differing, one.error.metrics,
                            fmt::format("{:.4g}", one.error.largest_force), fmt::format("{:.2e}", one.error.largest),
                            shown(contacts.grew, contacts.mesh), shown(contacts.unbalanced, contacts.mesh),
                            shown(contacts.dropped, contacts.closed), shown(contacts.phantoms, contacts.mesh),
                            shown(contacts.other, contacts.closed), one.passed ? "ok" : "FAILED: " + first_of(one));
        all.add(contacts);
    }
    if (all.mesh)
        text += fmt::format("contacts, judged at {} samples: grew, the proxy is further from the probe than the last "
                            "one was; unbalanced, the force is not along the normals of the facets at the proxy; "
                            "phantom, nothing stands between proxy and probe\n",
                            all.samples);
    if (all.closed)
        text +=
            fmt::format("drop-out and other side: a free probe, or a proxy in contact, is not on the side of a closed "
                        "mesh where its path began, by {} winding numbers, {} of them by loops over all triangles\n",
                        all.windings, all.brute);
    if (all.mesh)
        text += fmt::format(
            "{} samples are too near to the surface, or in too narrow a corner, for some of these checks\n", all.near);
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
                        {"contacts_judged", one.contacts.samples},
                        {"contacts_in_doubt", one.contacts.near},
                        {"winding_numbers", one.contacts.windings},
                        {"winding_numbers_by_loops", one.contacts.brute},
                        {"grew", one.contacts.grew},
                        {"unbalanced", one.contacts.unbalanced},
                        {"dropped_out", one.contacts.dropped},
                        {"phantoms", one.contacts.phantoms},
                        {"on_other_side", one.contacts.other},
                        {"passed", one.passed},
                        {"first_difference", first_of(one)}});
    return json.dump(2);
}

} // namespace forceshade
