#include "host/study/energy/energy_findings.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/energy/energy_curl_findings.h"
#include "host/study/energy/energy_least_findings.h"

namespace forceshade::study {
namespace {

constexpr double kMostNothing = 1e-6; /* of the effort: quadrature leaves no more, whatever closed forms say */
const std::string kGodObject = ", god-object";

/// "24 %", of a share.
std::string percent(double share) {
    return fmt::format("{:.2g} %", std::abs(share) < kRounding ? 0 : 100 * share);
}

/// "K = 500 N/m, out 2 mm deep and back 1 mm deep"; empty where the table does not say.
std::string terms(const Table& loops, std::size_t row) {
    for (const char* column : {"stiffness_N_per_m", "out_mm", "back_mm"})
        if (!loops.has(column) || !loops.number(row, column))
            return "";
    return fmt::format("K = {:.4g} N/m, out {:.4g} mm deep and back {:.4g} mm deep",
                       loops.needed(row, "stiffness_N_per_m"), loops.needed(row, "out_mm"),
                       loops.needed(row, "back_mm"));
}

/// Rows of a scheme over the bump at a radius in mil, those with the fewest facets first.
std::vector<std::size_t> bump_rows(const Table& loops, const std::string& scheme, double radius) {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < loops.rows.size(); ++row)
        if (loops.word(row, "scheme") == scheme && loops.word(row, "loop") != "whole" &&
            loops.number(row, "radius_mil") == radius && loops.number(row, "facets") &&
            loops.number(row, "gained_mJ") && loops.number(row, "effort_mJ"))
            rows.push_back(row);
    std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return loops.number(row, "facets"); });
    return rows;
}

/// What shading gives round a loop, in joules, beside the unshaded polygon and the effort: a share of the effort would
/// rise where the effort falls.
void add_shading(const Table& loops, std::vector<Finding>& findings) {
    const std::vector<std::size_t> shaded = bump_rows(loops, "shaded", 1000), plain = bump_rows(loops, "facets", 1000);
    if (shaded.empty() || plain.empty() ||
        loops.needed(shaded.front(), "facets") == loops.needed(shaded.back(), "facets"))
        return;
    const auto mj = [&](std::size_t row, const char* column) {
        const double value = loops.needed(row, column);
        return fmt::format("{:.2g}", std::abs(value) < 1e-9 ? 0 : value); // rounding
    };
    const auto facets = [&](std::size_t row) {
        const double count = loops.needed(row, "facets");
        return fmt::format("{:.0f} facet{}", count, count == 1 ? "" : "s");
    };
    findings.push_back(
        {"shading",
         fmt::format("Round a loop over a bump the shaded force gives {} mJ with {} and {} mJ with {}, "
                     "the unshaded one {} mJ with {} and {} mJ with {}.",
                     mj(shaded.front(), "gained_mJ"), facets(shaded.front()), mj(shaded.back(), "gained_mJ"),
                     facets(shaded.back()), mj(plain.front(), "gained_mJ"), facets(plain.front()),
                     mj(plain.back(), "gained_mJ"), facets(plain.back())),
         "", "bump with a radius of 1000 mil",
         fmt::format("one loop over half the bump{}; the effort is {} and {} mJ",
                     terms(loops, shaded.front()).empty() ? "" : ", " + terms(loops, shaded.front()),
                     mj(shaded.front(), "effort_mJ"), mj(shaded.back(), "effort_mJ")),
         ""});
}

/// As good as 0: rounding, or what quadrature leaves of loops that give nothing by their closed form.
double nothing(const Table& loops) {
    double most = kRounding;
    for (std::size_t row = 0; row < loops.rows.size(); ++row)
        if (loops.has("closed_form_mJ") && loops.number(row, "closed_form_mJ") == 0.0)
            most = std::max(most, 2 * loops.number(row, "closed_form_difference").value_or(0));
    return std::min(most, kMostNothing);
}

/// Schemes in the order of their rows, and the row of each with the largest size of eta.
std::vector<std::pair<std::string, std::size_t>> largest_rows(const Table& loops) {
    std::vector<std::pair<std::string, std::size_t>> largest;
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const std::string scheme = loops.word(row, "scheme");
        if (!loops.number(row, "eta"))
            continue;
        const auto found = std::ranges::find(largest, scheme, [](const auto& one) { return one.first; });
        if (found == largest.end())
            largest.emplace_back(scheme, row);
        else if (std::abs(loops.needed(row, "eta")) > std::abs(loops.needed(found->second, "eta")))
            found->second = row;
    }
    return largest;
}

/// Schemes that have as good as none in any row.
std::vector<std::string> conservative_schemes(const Table& loops) {
    const double limit = nothing(loops);
    std::vector<std::string> schemes;
    for (const auto& [scheme, row] : largest_rows(loops))
        if (std::abs(loops.needed(row, "eta")) < limit)
            schemes.push_back(scheme);
    return schemes;
}

/// Of the god-object: what its history takes or gives, beside the static field's.
void add_history(const Table& loops, std::vector<Finding>& findings) {
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const std::string scheme = loops.word(row, "scheme");
        const auto eta = loops.number(row, "eta");
        if (!scheme.ends_with(" none" + kGodObject) || loops.number(row, "facets") != 8.0 || !eta ||
            !loops.number(row, "radius_mil"))
            continue;
        const std::string says = std::abs(*eta) < kRounding ? "neither gives nor takes energy"
                                 : *eta < 0 ? fmt::format("takes at least {} of the effort from the hand, whichever "
                                                          "way the loop goes",
                                                          percent(-*eta))
                                            : fmt::format("gives up to {} of the effort", percent(*eta));
        findings.push_back(
            {"history", fmt::format("The god-object on a mesh of 8 cells over the bump with a radius of {:.6g} mil, "
                                    "unshaded, {}.",
                                    loops.needed(row, "radius_mil"), says)});
        return;
    }
}

/// Without tables that compare at equal errors, as of a user's scene: who gives least and most round a loop over half.
void add_scene(const StudyData& data, const Table& loops, std::vector<Finding>& findings) {
    if (data.find("equal_error") || loops.rows.empty() || !loops.has("loop"))
        return;
    std::optional<std::size_t> least, most;
    const auto eta = [&](std::size_t row) { return loops.needed(row, "eta"); };
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        if (loops.word(row, "loop") != "half" || !loops.number(row, "eta"))
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
    const std::string with = terms(loops, *least);
    findings.push_back(
        {"scene", fmt::format("Of this scene's schemes{} {} has the least energy to give: a loop {}; {} has "
                              "the most: a loop {}.",
                              with.empty() ? "" : fmt::format(" ({}, over half)", with), loops.word(*least, "scheme"),
                              gives(*least), loops.word(*most, "scheme"), gives(*most))});
}

} // namespace

std::vector<Finding> energy_findings(const StudyData& data) {
    std::vector<Finding> findings;
    const Table& loops = data.table("loops");
    add_least_at_equal_error(data, findings);
    add_scene(data, loops, findings);
    add_shading(loops, findings);
    add_history(loops, findings);
    add_curl(data, conservative_schemes(loops), findings);
    return findings;
}

} // namespace forceshade::study
