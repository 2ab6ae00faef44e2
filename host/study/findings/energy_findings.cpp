#include "host/study/findings/energy_findings.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade::study {
namespace {

constexpr double kRounding = 1e-9;    /* of the effort: less is nothing */
constexpr double kSteady = 0.05;      /* relative: a curve that changes less has levelled out */
constexpr std::size_t kMostNamed = 2; /* schemes in one place */
const std::string kGodObject = ", god-object";

struct Entry {
    std::string scheme;
    std::optional<double> facets;
    double eta;
};

/// The schemes at one error, those that give the least first.
std::vector<Entry> entries_at(const Table& equal, double level) {
    std::vector<Entry> entries;
    for (std::size_t row = 0; row < equal.rows.size(); ++row)
        if (equal.number(row, "error_deg") == level)
            entries.push_back(
                {equal.word(row, "scheme"), equal.number(row, "facets"), equal.number(row, "eta").value_or(0)});
    std::ranges::stable_sort(entries, {}, [](const Entry& one) { return std::max(std::abs(one.eta), kRounding); });
    return entries;
}

/// "33 facets over the width", "any number of facets".
std::string with_facets(const Entry& entry) {
    return entry.facets ? fmt::format("{:.3g} facets over the width", *entry.facets) : "any number of facets";
}

/// "triangles none; quads none (from 33 facets over the width)": the facets are the fewest of theirs.
std::string named(const std::vector<Entry>& entries) {
    std::vector<std::string> names;
    for (const Entry& entry : entries)
        if (names.size() < kMostNamed)
            names.push_back(entry.scheme);
    if (entries.size() > names.size())
        names.push_back(fmt::format("{} more", entries.size() - names.size()));
    const auto fewest = std::ranges::min_element(
        entries, {}, [](const Entry& one) { return one.facets.value_or(std::numeric_limits<double>::infinity()); });
    return fmt::format("{} ({}{})", fmt::join(names, "; "), names.size() > 1 ? "from " : "", with_facets(*fewest));
}

/// What schemes that have the same error give round a loop, the least first.
std::string least_text(double level, const std::vector<Entry>& entries) {
    std::vector<Entry> conservative, losing, giving;
    for (const Entry& entry : entries)
        (std::abs(entry.eta) < kRounding ? conservative : entry.eta < 0 ? losing : giving).push_back(entry);
    std::vector<std::string> parts;
    if (!conservative.empty())
        parts.push_back(fmt::format("no energy is to be had round a loop from {}", named(conservative)));
    if (!losing.empty())
        parts.push_back(fmt::format("a loop either way takes up to {:.2g} % of the effort from the hand with {}",
                                    -100 * losing.back().eta, named(losing)));
    if (!giving.empty())
        parts.push_back(fmt::format("{} the least, {:.2g} % of the effort, is given by {}{}",
                                    parts.empty() ? "energy comes of every scheme:" : "of those that give energy",
                                    100 * giving.front().eta, giving.front().scheme,
                                    " (" + with_facets(giving.front()) + ")"));
    if (giving.size() > 1)
        parts.push_back(fmt::format("the most, {:.2g} %, by {} ({})", 100 * giving.back().eta, giving.back().scheme,
                                    with_facets(giving.back())));
    return fmt::format("At the same direction error of {} deg (RMS) {}.", level, fmt::join(parts, "; "));
}

/// At the error that most schemes come to; of several the smallest.
void add_least(const StudyData& data, std::vector<Finding>& findings) {
    const Table* equal = data.find("equal_error");
    if (!equal || equal->rows.empty())
        return;
    std::map<double, std::size_t> counts;
    for (std::size_t row = 0; row < equal->rows.size(); ++row)
        ++counts[*equal->number(row, "error_deg")];
    double level = counts.begin()->first;
    for (const auto& [error, count] : counts)
        if (count > counts[level])
            level = error;
    findings.push_back({"least_at_equal_error", least_text(level, entries_at(*equal, level))});
}

/// The row of a scheme at a radius with the fewest or the most facets.
std::optional<std::size_t> extreme_row(const Table& loops, const std::string& scheme, double radius, bool most) {
    std::optional<std::size_t> found;
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const auto facets = loops.number(row, "facets"), radius_here = loops.number(row, "radius_mil");
        if (loops.word(row, "scheme") != scheme || !facets || radius_here != radius)
            continue;
        if (!found || (most ? *facets > *loops.number(*found, "facets") : *facets < *loops.number(*found, "facets")))
            found = row;
    }
    return found;
}

void add_shading(const Table& loops, std::vector<Finding>& findings) {
    constexpr double kRadius = 1000; /* mil */
    const auto coarse = extreme_row(loops, "shaded", kRadius, false),
               fine = extreme_row(loops, "shaded", kRadius, true);
    if (!coarse || !fine || *coarse == *fine)
        return;
    const double few = *loops.number(*coarse, "facets"), many = *loops.number(*fine, "facets");
    const double before = std::abs(*loops.number(*coarse, "eta")), after = std::abs(*loops.number(*fine, "eta"));
    const std::string change = std::abs(after - before) <= kSteady * before ? "it stays so"
                               : after < before ? fmt::format("it falls to {:.2g} %", 100 * after)
                                                : fmt::format("it rises to {:.2g} %", 100 * after);
    findings.push_back(
        {"shading",
         fmt::format("Force shading a bump of 1000 mil with {:.0f} facet{} gives {:.3g} mJ a round, {:.2g} % "
                     "of the effort; with {:.0f} facets {}{}.",
                     few, few == 1 ? "" : "s", *loops.number(*coarse, "gained_mJ"), 100 * before, many, change,
                     after < kRounding ? "" : ", and not to 0: depth is read vertically")});
}

/// As good as 0: rounding, or what quadrature leaves of loops that give nothing by their closed form.
double nothing(const Table& loops) {
    double most = kRounding;
    for (std::size_t row = 0; row < loops.rows.size(); ++row)
        if (loops.has("closed_form_mJ") && loops.number(row, "closed_form_mJ") == 0.0)
            most = std::max(most, 2 * loops.number(row, "closed_form_difference").value_or(0));
    return most;
}

/// Schemes that have no more than that in any row.
void add_conservative(const Table& loops, std::vector<Finding>& findings) {
    std::vector<std::string> order;
    std::map<std::string, double> largest;
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const std::string scheme = loops.word(row, "scheme");
        if (!largest.contains(scheme))
            order.push_back(scheme);
        largest[scheme] = std::max(largest[scheme], std::abs(loops.number(row, "eta").value_or(0)));
    }
    if (order.empty())
        return;
    const double limit = nothing(loops);
    std::vector<std::string> none;
    std::string most = order.front();
    for (const std::string& scheme : order) {
        if (largest[scheme] < limit)
            none.push_back(scheme);
        if (largest[scheme] > largest[most])
            most = scheme;
    }
    const std::string rest = fmt::format("the most, {:.2g} % of the effort, is that of {}", 100 * largest[most], most);
    findings.push_back({"conservative", none.empty() ? fmt::format("No scheme here is conservative; {}.", rest)
                                                     : fmt::format("Conservative, to {:.1g} of the effort: {}; {}.",
                                                                   limit, fmt::join(none, "; "), rest)});
}

/// Of the god-object: what its history takes or gives, beside the static field's.
void add_history(const Table& loops, std::vector<Finding>& findings) {
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const std::string scheme = loops.word(row, "scheme");
        if (!scheme.ends_with(" none" + kGodObject) || loops.number(row, "facets") != 8.0)
            continue;
        const double eta = loops.number(row, "eta").value_or(0);
        const std::string says = std::abs(eta) < kRounding ? "neither gives nor takes energy"
                                 : eta < 0 ? fmt::format("takes at least {:.2g} % of the effort from the "
                                                         "hand, whichever way the loop goes",
                                                         -100 * eta)
                                           : fmt::format("gives up to {:.2g} % of the effort", 100 * eta);
        findings.push_back(
            {"history", fmt::format("The god-object on a mesh of 8 cells over the bump, unshaded, {}.", says)});
        return;
    }
}

void add_laws(const StudyData& data, std::vector<Finding>& findings) {
    const Table* laws = data.find("laws");
    if (!laws || laws->rows.empty())
        return;
    std::vector<std::string> missed;
    for (std::size_t row = 0; row < laws->rows.size(); ++row)
        if (laws->word(row, "holds") != "yes")
            missed.push_back(fmt::format("{} at {} mil: {}, printed {}", laws->word(row, "law"),
                                         *laws->number(row, "radius_mil"), *laws->number(row, "found"),
                                         *laws->number(row, "printed")));
    const std::size_t count = laws->rows.size();
    findings.push_back(
        {"laws", fmt::format("{} of {} energy values of the laws are reproduced within their "
                             "tolerances{}{}.",
                             count - missed.size(), count, missed.empty() ? "" : "; not ", fmt::join(missed, "; "))});
}

void add_engine(const Table& loops, std::vector<Finding>& findings) {
    double largest = -1;
    std::string scheme;
    for (std::size_t row = 0; row < loops.rows.size(); ++row)
        if (const auto off = loops.number(row, "engine_difference"); off && *off > largest) {
            largest = *off;
            scheme = loops.word(row, "scheme");
        }
    if (largest >= 0)
        findings.push_back({"engine", fmt::format("Work added up from the engine's samples is within {:.1g} of the "
                                                  "effort of the oracle's; the most is at {}.",
                                                  largest, scheme)});
}

/// Without tables that compare at equal errors, as of a user's scene: who gives least and most round a loop over half.
void add_scene(const StudyData& data, const Table& loops, std::vector<Finding>& findings) {
    if (data.find("equal_error") || loops.rows.empty() || !loops.has("loop"))
        return;
    std::optional<std::size_t> least, most;
    const auto eta = [&](std::size_t row) { return loops.number(row, "eta").value_or(0); };
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        if (loops.word(row, "loop") != "half")
            continue;
        least = !least || eta(row) < eta(*least) ? row : *least;
        most = !most || eta(row) > eta(*most) ? row : *most;
    }
    if (!least || *least == *most)
        return;
    const auto gives = [&](std::size_t row) {
        const double value = eta(row);
        return value < -nothing(loops)
                   ? fmt::format("takes at least {:.2g} % of the effort whichever way it goes", -100 * value)
               : value < nothing(loops) ? std::string("gives none")
                                        : fmt::format("gives {:.2g} % of the effort", 100 * value);
    };
    findings.push_back(
        {"scene", fmt::format("Of this scene's schemes {} has the least energy to give: a loop {}; {} has "
                              "the most: a loop {}.",
                              loops.word(*least, "scheme"), gives(*least), loops.word(*most, "scheme"), gives(*most))});
}

/// Which map has the least curl and which the most, and how far one is from its closed form.
void add_curl(const StudyData& data, std::vector<Finding>& findings) {
    const Table* maps = data.find("curl_maps");
    if (!maps)
        return;
    std::optional<std::size_t> least, most;
    double off = -1;
    for (std::size_t row = 0; row < maps->rows.size(); ++row) {
        off = std::max(off, maps->number(row, "closed_form_difference_per_K").value_or(-1));
        const auto rms = maps->number(row, "rms_per_K");
        if (!rms)
            continue;
        least = !least || *rms < *maps->number(*least, "rms_per_K") ? row : *least;
        most = !most || *rms > *maps->number(*most, "rms_per_K") ? row : *most;
    }
    if (!least || *least == *most)
        return;
    const auto named = [&](std::size_t row) {
        return fmt::format("{} ({:.1g} K, RMS)", maps->word(row, "map"), *maps->number(row, "rms_per_K"));
    };
    findings.push_back(
        {"curl",
         fmt::format("The least curl has {}, the most {}{}.", named(*least), named(*most),
                     off < 0 ? ""
                             : fmt::format("; that of the flat shaded plane is its closed form to {:.1g} K", off))});
}

} // namespace

std::vector<Finding> energy_findings(const StudyData& data) {
    std::vector<Finding> findings;
    const Table& loops = data.table("loops");
    add_least(data, findings);
    add_scene(data, loops, findings);
    add_shading(loops, findings);
    add_conservative(loops, findings);
    add_history(loops, findings);
    add_curl(data, findings);
    add_laws(data, findings);
    add_engine(loops, findings);
    return findings;
}

} // namespace forceshade::study
