#include "host/study/omission/omission_findings.h"

#include <algorithm>
#include <functional>
#include <map>

#include <fmt/format.h>

namespace forceshade::study {
namespace {

constexpr const char* kControl = "nothing"; // the feature of a row whose sides are alike
constexpr const char* kFlat = "flat texture";

using Rows = std::vector<std::size_t>;

std::string number(double value) {
    return value >= 9.95 ? fmt::format("{:.0f}", value) : fmt::format("{:.2f}", value);
}

// "every y (bump)".
std::string name_of(const Table& table, std::size_t row) {
    return fmt::format("{} ({})", table.word(row, "feature"), table.word(row, "scene"));
}

Rows rows_with(const Table& table, const std::function<bool(std::size_t)>& holds) {
    Rows rows;
    for (std::size_t row = 0; row < table.rows.size(); ++row)
        if (holds(row))
            rows.push_back(row);
    return rows;
}

// All but the controls.
Rows features_with(const Table& table, const char* column, const std::string& word) {
    return rows_with(table, [&](std::size_t row) {
        return table.word(row, "feature") != kControl && table.word(row, column) == word;
    });
}

// By the feature, with the scenes that it was measured in and what it saved there: "facet channel (bump 1.2 %, mesh
// -0.3 %)"; `saved`: the column, none for scenes alone.
std::string listed(const Table& table, const Rows& rows, const char* saved = nullptr) {
    std::vector<std::string> features;
    std::map<std::string, std::vector<std::string>> scenes;
    for (const std::size_t row : rows) {
        const std::string feature = table.word(row, "feature");
        if (scenes[feature].empty())
            features.push_back(feature);
        const std::string scene = table.word(row, "scene");
        scenes[feature].push_back(saved ? fmt::format("{} {:.1f} %", scene, table.needed(row, saved)) : scene);
    }
    std::vector<std::string> parts;
    for (const std::string& feature : features)
        parts.push_back(fmt::format("{} ({})", feature, fmt::join(scenes[feature], ", ")));
    return fmt::format("{}", fmt::join(parts, ", "));
}

Rows by_falling(const Table& table, Rows rows, const char* column) {
    std::ranges::stable_sort(
        rows, [&](std::size_t a, std::size_t b) { return table.needed(a, column) > table.needed(b, column); });
    return rows;
}

// What a time's omissions save most, and the next after it.
Finding most_time(const Table& table, const char* name, const std::string& kind, const std::string& time) {
    const std::string verdict = kind + "_verdict", ratio = kind + "_ratio";
    const Rows rows = by_falling(table, features_with(table, verdict.c_str(), "saves"), ratio.c_str());
    if (rows.empty())
        return {name, fmt::format("No omission saves {} that can be told from the spread.", time)};
    const auto value = [&](std::size_t row, const std::string& column) { return table.needed(row, column); };
    const std::size_t best = rows.front();
    std::string text =
        fmt::format("Leaving out {} saves the most {}: with it a sample takes {} times as long (quartiles "
                    "{} to {}), {} instead of {} ns: that saves {:.0f} % of the time",
                    name_of(table, best), time, number(value(best, ratio)), number(value(best, ratio + "_q1")),
                    number(value(best, ratio + "_q3")), number(value(best, kind + "_ns_with")),
                    number(value(best, kind + "_ns_without")), value(best, kind + "_saved_percent"));
    if (rows.size() > 1)
        text += fmt::format("; next comes {} with {} times", name_of(table, rows[1]), number(value(rows[1], ratio)));
    if (rows.size() > 2)
        text += fmt::format(", then {} with {} times", name_of(table, rows[2]), number(value(rows[2], ratio)));
    return {name, text + "."};
}

Finding most_bytes(const Table& table) {
    const auto most = [&](const char* column) {
        return by_falling(table,
                          rows_with(table,
                                    [&](std::size_t row) {
                                        return table.word(row, "feature") != kControl &&
                                               table.number(row, column).value_or(0) > 1;
                                    }),
                          column);
    };
    const Rows moved = most("bytes_ratio"), files = most("file_ratio");
    std::string text =
        moved.empty() ? "No omission saves bytes to or from the device"
                      : fmt::format("Leaving out {} saves the most bytes to and from the device: with it there "
                                    "are {} times as many",
                                    name_of(table, moved.front()), number(table.needed(moved.front(), "bytes_ratio")));
    if (files.empty())
        text += "; no omission makes a file smaller";
    else
        text += fmt::format("; the file shrinks most without {}: with it it is {} times as large",
                            name_of(table, files.front()), number(table.needed(files.front(), "file_ratio")));
    return {"most_bytes", text + "."};
}

Finding saves_nothing(const Table& table) {
    const Rows rows = features_with(table, "kernel_verdict", "within the spread");
    if (rows.empty())
        return {"saves_nothing", "Every feature switched makes a difference to the kernel's time beyond the spread."};
    return {"saves_nothing", fmt::format("Leaving these out saves no kernel time that can be told from the spread: {}.",
                                         listed(table, rows, "kernel_saved_percent"))};
}

Finding costs(const Table& table) {
    const Rows rows = features_with(table, "kernel_verdict", "costs");
    if (rows.empty())
        return {"costs", "No omission makes a kernel slower."};
    const auto ratio = [&](std::size_t row) { return 1 / table.needed(row, "kernel_ratio"); };
    const std::size_t worst =
        *std::ranges::max_element(rows, [&](std::size_t a, std::size_t b) { return ratio(a) < ratio(b); });
    return {"costs", fmt::format("Leaving these out makes the kernel slower, not faster: {}; the most {}, {} times as "
                                 "long without it.",
                                 listed(table, rows), name_of(table, worst), number(ratio(worst)))};
}

Finding unchanged(const Table& table) {
    double compared = 0, in_contact = 0;
    std::size_t comparisons = 0; // a feature that moves the probe leaves nothing to compare
    Rows changed;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const double here = table.number(row, "compared").value_or(0);
        compared += here;
        comparisons += here > 0;
        in_contact += table.number(row, "in_contact").value_or(0);
        if (table.number(row, "differing").value_or(0) > 0)
            changed.push_back(row);
    }
    if (changed.empty())
        return {"unchanged", fmt::format("Switching a feature changes nothing that it does not concern: 0 of {:.0f} "
                                         "samples ({:.0f} in contact) differ in {} comparisons.",
                                         compared, in_contact, comparisons)};
    std::vector<std::string> parts;
    for (const std::size_t row : changed)
        parts.push_back(fmt::format("{} in {:.0f} of {:.0f} samples", name_of(table, row),
                                    table.needed(row, "differing"), table.number(row, "compared").value_or(0)));
    return {"unchanged", fmt::format("Switching a feature changes what it does not concern: {}; the other {} of {} "
                                     "comparisons hold.",
                                     fmt::join(parts, ", "), comparisons - changed.size(), comparisons)};
}

Finding manifest(const Table& table, const Table& omitted) {
    const Rows wrong = rows_with(table, [&](std::size_t row) { return table.word(row, "manifest_agrees") == "no"; });
    const Rows missed =
        rows_with(omitted, [&](std::size_t row) { return omitted.word(row, "feature") == "not measured"; });
    if (wrong.empty() && missed.empty())
        return {"manifest", fmt::format("The manifests tell of every omission that was measured, and all {} that they "
                                        "tell of were measured.",
                                        omitted.rows.size())};
    std::string text = wrong.empty() ? "The manifests tell of every omission that was measured"
                                     : "The manifests do not agree with what was left out of " + listed(table, wrong);
    std::vector<std::string> parts;
    for (const std::size_t row : missed)
        parts.push_back(fmt::format("{} ({})", omitted.word(row, "omitted"), omitted.word(row, "scene")));
    if (!parts.empty())
        text += fmt::format("; they tell of {} that {} not measured", fmt::join(parts, ", "),
                            parts.size() > 1 ? "were" : "was");
    return {"manifest", text + "."};
}

// What a feature costs that is compiled in and does nothing.
void add_specialised(const Table& table, std::vector<Finding>& findings) {
    const Rows rows = by_falling(
        table, rows_with(table, [&](std::size_t row) { return table.word(row, "feature") == kFlat; }), "kernel_ratio");
    if (rows.empty())
        return;
    const auto all = [&](const char* verdict) {
        return std::ranges::all_of(rows, [&](std::size_t row) { return table.word(row, "kernel_verdict") == verdict; });
    };
    const Rows beyond = rows_with(table, [&](std::size_t row) {
        return table.word(row, "feature") == kFlat && table.word(row, "kernel_verdict") != "within the spread";
    });
    const double most = table.needed(rows.front(), "kernel_ratio"), least = table.needed(rows.back(), "kernel_ratio");
    const std::string range = rows.size() > 1
                                  ? fmt::format("{} to {} times the kernel time", number(least), number(most))
                                  : fmt::format("{} times the kernel time, quartiles {} to {}", number(most),
                                                number(table.needed(rows.front(), "kernel_ratio_q1")),
                                                number(table.needed(rows.front(), "kernel_ratio_q3")));
    findings.push_back(
        {"specialised",
         all("saves")
             ? fmt::format("A texture that is compiled in and flat costs {}, for the same forces: that is what "
                           "leaving it out of the compiled kernel is worth.",
                           range)
         : all("within the spread")
             ? fmt::format(
                   "A texture that is compiled in and flat costs nothing that can be told from the spread ({}).", range)
             : fmt::format("A texture that is compiled in and flat costs {}, by the scene; beyond the spread in {}.",
                           range, listed(table, beyond))});
}

void add_control(const Table& table, std::vector<Finding>& findings) {
    const Rows rows = rows_with(table, [&](std::size_t row) { return table.word(row, "feature") == kControl; });
    if (rows.empty())
        return;
    std::vector<std::string> parts;
    for (const std::size_t row : rows)
        if (const auto ratio = table.number(row, "kernel_ratio"))
            parts.push_back(fmt::format("{:.3f} ({})", *ratio, table.word(row, "scene")));
    if (!parts.empty())
        findings.push_back(
            {"control", fmt::format("With nothing switched the ratio of kernel times is {} in the median "
                                    "of the rounds: a smaller effect cannot be told there.",
                                    fmt::join(parts, ", "))});
}

} // namespace

std::vector<Finding> omission_findings(const StudyData& data) {
    const Table &features = data.table("features"), &omitted = data.table("omitted");
    std::vector<Finding> findings{most_time(features, "most_kernel_time", "kernel", "kernel time"),
                                  unchanged(features),
                                  most_time(features, "most_time", "whole", "time by the clock"),
                                  most_bytes(features),
                                  saves_nothing(features),
                                  costs(features)};
    add_specialised(features, findings);
    add_control(features, findings);
    findings.push_back(manifest(features, omitted));
    return findings;
}

} // namespace forceshade::study
