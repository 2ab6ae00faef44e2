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
constexpr double kLastDigits = 1e-13; /* of the effort: sums of thousands of numbers are off by that */
constexpr double kSteady = 0.05;      /* relative: a curve that changes less is level */
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

/// " (512 facets, radius of 600 mil)": what tells a scheme's rows apart, where there is anything.
std::string place(const Table& loops, std::size_t row) {
    std::vector<std::string> parts;
    if (const auto facets = loops.number(row, "facets"))
        parts.push_back(fmt::format("{:.0f} {}{}", *facets,
                                    loops.word(row, "group").starts_with("mesh") ? "cell" : "facet",
                                    *facets == 1 ? "" : "s"));
    if (const auto radius = loops.number(row, "radius_mil"))
        parts.push_back(fmt::format("radius of {:.6g} mil", *radius));
    if (loops.word(row, "loop") == "whole")
        parts.emplace_back("the whole loop");
    return parts.empty() ? "" : fmt::format(" ({})", fmt::join(parts, ", "));
}

/// Rows of the shaded bump at a radius in mil, those with the fewest facets first.
std::vector<std::size_t> shaded_rows(const Table& loops, double radius) {
    std::vector<std::size_t> rows;
    for (std::size_t row = 0; row < loops.rows.size(); ++row)
        if (loops.word(row, "scheme") == "shaded" && loops.word(row, "loop") != "whole" &&
            loops.number(row, "radius_mil") == radius && loops.number(row, "facets") && loops.number(row, "eta") &&
            loops.number(row, "gained_mJ"))
            rows.push_back(row);
    std::ranges::stable_sort(rows, {}, [&](std::size_t row) { return loops.number(row, "facets"); });
    return rows;
}

/// How the shaded bump's energy goes with its facets: with the fewest, at its least, with the most.
void add_shading(const Table& loops, std::vector<Finding>& findings) {
    const std::vector<std::size_t> rows = shaded_rows(loops, 1000);
    const auto facets = [&](std::size_t row) { return loops.needed(row, "facets"); };
    const auto eta = [&](std::size_t row) { return loops.needed(row, "eta"); };
    if (rows.empty() || facets(rows.front()) == facets(rows.back()))
        return;
    const std::size_t few = rows.front(), many = rows.back();
    const auto [least, most] = std::ranges::minmax(rows, {}, eta);
    const std::string last = fmt::format("with {:.0f}, the most facets here,", facets(many));
    std::string change;
    if (eta(most) - eta(least) <= kSteady * std::abs(eta(few)))
        change = fmt::format("up to {:.0f}, the most facets here, it stays so", facets(many));
    else if (least == few)
        change = fmt::format("that is the least: {} it is {}", last, percent(eta(many)));
    else if (least == many)
        change = fmt::format("{} it is least, {}", last, percent(eta(many)));
    else
        change = fmt::format("it is least with {:.0f} facets, {}; {} it is {}", facets(least), percent(eta(least)),
                             last, percent(eta(many)));
    const std::string with = terms(loops, few);
    findings.push_back(
        {"shading", fmt::format("Force shading a bump with a radius of 1000 mil and {:.0f} facet{} gives {:.3g} mJ a "
                                "round{}, {} of the effort; {}.",
                                facets(few), facets(few) == 1 ? "" : "s", loops.needed(few, "gained_mJ"),
                                with.empty() ? "" : fmt::format(" ({})", with), percent(eta(few)), change)});
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

void add_conservative(const Table& loops, std::vector<Finding>& findings) {
    const auto largest = largest_rows(loops);
    if (largest.empty())
        return;
    const double limit = nothing(loops);
    const std::vector<std::string> none = conservative_schemes(loops);
    const auto size = [&](const auto& one) { return std::abs(loops.needed(one.second, "eta")); };
    const auto most = *std::ranges::max_element(largest, {}, size);
    const std::string rest = size(most) < limit
                                 ? std::string()
                                 : fmt::format("; the most, {:.2g} % of the effort, is {} by {}{}", 100 * size(most),
                                               loops.needed(most.second, "eta") < 0 ? "taken" : "given", most.first,
                                               place(loops, most.second));
    findings.push_back({"conservative", none.empty() ? fmt::format("No scheme here is conservative{}.", rest)
                                                     : fmt::format("Conservative, to {:.1g} of the effort: {}{}.",
                                                                   limit, fmt::join(none, "; "), rest)});
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

void add_laws(const StudyData& data, std::vector<Finding>& findings) {
    const Table* laws = data.find("laws");
    if (!laws || laws->rows.empty())
        return;
    const auto at = [&](std::size_t row, const char* column) {
        const auto number = laws->number(row, column);
        return number ? fmt::format("{}", *number) : std::string("no number");
    };
    std::vector<std::string> missed;
    for (std::size_t row = 0; row < laws->rows.size(); ++row)
        if (laws->word(row, "holds") != "yes")
            missed.push_back(fmt::format("{} at {} mil: {}, printed {}", laws->word(row, "law"), at(row, "radius_mil"),
                                         at(row, "found"), at(row, "printed")));
    const std::size_t count = laws->rows.size();
    findings.push_back(
        {"laws", fmt::format("{} of {} energy values of the laws are reproduced within their "
                             "tolerances{}{}.",
                             count - missed.size(), count, missed.empty() ? "" : "; not ", fmt::join(missed, "; "))});
}

void add_engine(const Table& loops, std::vector<Finding>& findings) {
    double largest = -1;
    std::size_t most = 0;
    for (std::size_t row = 0; row < loops.rows.size(); ++row)
        if (const auto off = loops.number(row, "engine_difference"); off && *off > largest) {
            largest = *off;
            most = row;
        }
    if (largest < 0)
        return;
    const std::string at = loops.word(most, "scheme") + place(loops, most);
    findings.push_back(
        {"engine",
         "Work added up from the engine's samples is the oracle's " +
             (largest == 0            ? std::string("to the last bit.")
              : largest < kLastDigits ? fmt::format("to rounding, {:.1g} of the effort at {}.", largest, at)
                                      : fmt::format("within {:.1g} of the effort; the most is at {}.", largest, at))});
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
    add_conservative(loops, findings);
    add_history(loops, findings);
    add_curl(data, conservative_schemes(loops), findings);
    add_laws(data, findings);
    add_engine(loops, findings);
    return findings;
}

} // namespace forceshade::study
