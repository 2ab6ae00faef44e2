#include "host/study/omission/omission_findings.h"

#include <algorithm>
#include <functional>
#include <map>

#include <fmt/format.h>

namespace forceshade::study {
namespace {

constexpr const char* kControl = "nothing"; // the feature of a row whose sides are alike

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

// What may be left out: the same forces come out without it. No controls.
bool may_be_left_out(const Table& table, std::size_t row) {
    return table.word(row, "feature") != kControl && table.word(row, "same_forces") == "yes";
}

Rows features_with(const Table& table, const char* column, const std::string& word) {
    return rows_with(table,
                     [&](std::size_t row) { return may_be_left_out(table, row) && table.word(row, column) == word; });
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
                                        return may_be_left_out(table, row) && table.number(row, column).value_or(0) > 1;
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
    const Table& features = data.table("features");
    std::vector<Finding> findings{most_time(features, "most_kernel_time", "kernel", "kernel time"),
                                  most_time(features, "most_time", "whole", "time by the clock"), most_bytes(features),
                                  saves_nothing(features)};
    add_control(features, findings);
    for (Finding& finding : findings) {
        finding.figure = finding.name == "most_bytes" ? "bytes" : finding.name == "most_time" ? "whole" : "kernel";
        finding.condition = "of what leaves every force as it is; medians of paired rounds, quartiles beside";
    }
    return findings;
}

} // namespace forceshade::study
