#include "host/study/energy/energy_least_findings.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade::study {
namespace {

constexpr std::size_t kMostNamed = 2; /* schemes in one place */
constexpr double kMostSchemes = 0.9;  /* of those that keep to some error: so many are compared */

struct Entry {
    std::string scheme, group;
    double facets, eta;
};

/// The schemes that keep to one error, those that give the least first.
std::vector<Entry> entries_at(const Table& equal, double level) {
    std::vector<Entry> entries;
    for (std::size_t row = 0; row < equal.rows.size(); ++row)
        if (const auto facets = equal.number(row, "facets"), eta = equal.number(row, "eta");
            facets && eta && equal.number(row, "error_deg") == level)
            entries.push_back({equal.word(row, "scheme"), equal.word(row, "group"), *facets, *eta});
    std::ranges::stable_sort(entries, {}, [](const Entry& one) { return std::max(std::abs(one.eta), kRounding); });
    return entries;
}

/// "32 facets", of a mesh "32 cells".
std::string with_facets(const Entry& entry) {
    const char* what = entry.group.starts_with("mesh") ? "cell" : "facet";
    return fmt::format("{:.0f} {}{}", entry.facets, what, entry.facets == 1 ? "" : "s");
}

/// "triangles none; quads none (from 64 cells)": the facets are the fewest of theirs.
std::string named(const std::vector<Entry>& entries) {
    std::vector<std::string> names;
    for (const Entry& entry : entries)
        if (names.size() < kMostNamed)
            names.push_back(entry.scheme);
    if (entries.size() > names.size())
        names.push_back(fmt::format("{} more", entries.size() - names.size()));
    const auto fewest = std::ranges::min_element(entries, {}, &Entry::facets);
    return fmt::format("{} ({}{})", fmt::join(names, "; "), names.size() > 1 ? "from " : "", with_facets(*fewest));
}

/// "takes at least 0.03 to 1.3 % of the effort", of schemes that take whichever way the loop goes, the least first.
std::string taken(const std::vector<Entry>& losing) {
    const std::string least = fmt::format("{:.2g}", -100 * losing.front().eta),
                      most = fmt::format("{:.2g}", -100 * losing.back().eta);
    return least == most
               ? fmt::format("takes at least {} % of the effort from the hand", most)
               : fmt::format("takes at least {} to {} % of the effort from the hand, by the scheme,", least, most);
}

/// What schemes that keep to the same error give round a loop, the least first.
std::string least_text(double level, const std::vector<Entry>& entries) {
    std::vector<Entry> conservative, losing, giving;
    for (const Entry& entry : entries)
        (std::abs(entry.eta) < kRounding ? conservative : entry.eta < 0 ? losing : giving).push_back(entry);
    std::vector<std::string> parts;
    if (!conservative.empty())
        parts.push_back(fmt::format("no energy is to be had round a loop from {}", named(conservative)));
    if (!losing.empty())
        parts.push_back(fmt::format("a loop either way {} with {}", taken(losing), named(losing)));
    if (!giving.empty())
        parts.push_back(fmt::format("{} the least, {:.2g} % of the effort, is given by {}{}",
                                    parts.empty() ? "energy comes of every scheme:" : "of those that give energy",
                                    100 * giving.front().eta, giving.front().scheme,
                                    " (" + with_facets(giving.front()) + ")"));
    if (giving.size() > 1)
        parts.push_back(fmt::format("the most, {:.2g} %, by {} ({})", 100 * giving.back().eta, giving.back().scheme,
                                    with_facets(giving.back())));
    return fmt::format("On the bump with a radius of 1000 mil, each scheme with the fewest facets or cells here that "
                       "keep its direction error to {} deg (RMS): {}.",
                       level, fmt::join(parts, "; "));
}

} // namespace

void add_least_at_equal_error(const StudyData& data, std::vector<Finding>& findings) {
    const Table* equal = data.find("equal_error");
    if (!equal || equal->rows.empty())
        return;
    std::map<double, std::size_t> counts;
    for (std::size_t row = 0; row < equal->rows.size(); ++row)
        if (const auto error = equal->number(row, "error_deg"))
            ++counts[*error];
    if (counts.empty())
        return;
    std::size_t most = 0;
    for (const auto& [error, count] : counts)
        most = std::max(most, count);
    const double level = std::ranges::find_if(counts, [&](const auto& one) {
                             return static_cast<double>(one.second) >= kMostSchemes * static_cast<double>(most);
                         })->first;
    if (const std::vector<Entry> entries = entries_at(*equal, level); !entries.empty())
        findings.push_back({"least_at_equal_error", least_text(level, entries)});
}

} // namespace forceshade::study
