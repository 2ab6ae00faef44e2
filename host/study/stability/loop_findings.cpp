#include "host/study/stability/loop_findings.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>

#include "host/study/data/median.h"
#include "host/study/stability/loop_map_findings.h"

namespace forceshade::study {
namespace {

constexpr const char* kPlane = "plane";
constexpr double kMedianPromised = 1; // %: of the median disagreement on the plane

// A row of the limits in which a limit was found.
struct Limit {
    std::string surface, series;
    double mass, damping, rate, delay;             /* kg, N s/m, Hz, samples */
    double grip;                                   /* N/m */
    double measured, off, over_passive, over_wall; /* N/m, %, 1, 1 */
    std::optional<double> flutter, own;            /* N/m */
    bool same_hand(const Limit& other) const {
        return mass == other.mass && damping == other.damping && rate == other.rate;
    }
};

std::vector<Limit> limits_of(const Table& table) {
    std::vector<Limit> limits;
    for (std::size_t row = 0; row < table.rows.size(); ++row) {
        const auto number = [&](const char* column) { return table.number(row, column).value_or(0); };
        if (table.number(row, "measured_N_per_m") && table.number(row, "disagreement_size_percent"))
            limits.push_back({table.word(row, "surface"), table.word(row, "series"), number("mass_kg"),
                              number("damping_N_s_per_m"), number("rate_Hz"), number("delay_samples"),
                              number("grip_N_per_m"), number("measured_N_per_m"), number("disagreement_size_percent"),
                              number("over_passive_1"), number("over_wall_1"), table.number(row, "flutter_N_per_m"),
                              table.number(row, "own_N_per_m")});
    }
    return limits;
}

template <typename Keep> std::vector<Limit> chosen(const std::vector<Limit>& limits, const Keep& keep) {
    std::vector<Limit> some;
    std::ranges::copy_if(limits, std::back_inserter(some), keep);
    return some;
}

template <typename Value> std::vector<double> each(const std::vector<Limit>& limits, const Value& value) {
    std::vector<double> values;
    for (const Limit& limit : limits)
        values.push_back(value(limit));
    return values;
}

std::string hand_of(const Limit& limit) {
    return fmt::format("{:.4g} kg, {:.4g} N s/m and {:.4g} Hz", limit.mass, limit.damping, limit.rate);
}

// Limits are of one place of a surface, as the table has it.
void add(std::vector<Finding>& findings, const char* name, std::string text) {
    if (!text.empty())
        findings.push_back({name, std::move(text), "",
                            "one place of each surface, as loop_limits has it: others may bear less", "", ""});
}

// Stiffnesses in full.
std::string newton_per_metre(double stiffness) {
    return stiffness >= 1000 ? fmt::format("{:.0f} N/m", stiffness) : fmt::format("{:.4g} N/m", stiffness);
}

// " A spring of 200 N/m holds the hand sideways (bump; mesh)."
std::string grips_of(const std::vector<Limit>& limits) {
    std::map<double, std::vector<std::string>> series;
    for (const Limit& one : limits)
        if (one.grip > 0)
            series[one.grip].push_back(one.series);
    std::string text;
    for (const auto& [grip, held] : series)
        text += fmt::format(" A spring of {} holds the hand sideways{}.", newton_per_metre(grip),
                            held.size() == limits.size() ? "" : fmt::format(" ({})", fmt::join(held, "; ")));
    return text.empty() ? " Nothing holds the hand sideways." : text;
}

std::string about_scene(const std::vector<Limit>& limits) {
    for (const Limit& one : limits)
        if (one.own)
            return fmt::format(
                "The {} is stable up to {} with {} ({:.3g} of a wall's K_crit): its own {} {}.{}", one.series,
                newton_per_metre(one.measured), hand_of(one), one.over_wall, newton_per_metre(*one.own),
                *one.own < one.measured ? fmt::format("is {:.3g} of that", *one.own / one.measured)
                                        : fmt::format("is {:.3g} times too much", *one.own / one.measured),
                grips_of({one}));
    return "";
}

// The damping that the most surfaces were taken through, all other things the same; the least of several.
std::vector<Limit> compared(const std::vector<Limit>& limits) {
    std::vector<Limit> best;
    for (const Limit& one : limits) {
        const auto same = chosen(
            limits, [&](const Limit& limit) { return limit.same_hand(one) && limit.delay == 0 && one.delay == 0; });
        const bool less = !best.empty() && same.size() == best.size() && one.damping < best.front().damping;
        if (same.size() > best.size() || less)
            best = same;
    }
    return best;
}

std::string about_surfaces(const std::vector<Limit>& limits) {
    std::vector<Limit> same = compared(limits);
    if (same.size() < 2)
        return "";
    std::ranges::stable_sort(same, {}, [](const Limit& limit) { return -limit.measured; });
    std::vector<std::string> parts;
    for (const Limit& limit : same)
        parts.push_back(fmt::format("{} {}", limit.series, newton_per_metre(limit.measured)));
    const Limit& least = same.back();
    return fmt::format("With {}, surfaces are stable up to: {}. {}{}", hand_of(least), fmt::join(parts, "; "),
                       least.over_wall < 0.95
                           ? fmt::format("The {} gives way first, {:.3g} times below a wall's K_crit.", least.series,
                                         1 / least.over_wall)
                           : "None gives way far below a wall's K_crit.",
                       grips_of(same));
}

// A surface without and with shading, over the damping that both have.
std::string about_shading(const std::vector<Limit>& limits, const std::string& bare) {
    const auto of = [&](const std::string& surface) {
        auto some = chosen(limits, [&](const Limit& one) { return one.surface == surface && one.delay == 0; });
        std::ranges::stable_sort(some, {}, &Limit::damping);
        return some;
    };
    std::vector<Limit> without = of(bare), with = of(bare + "-shaded");
    const auto has_no_partner = [](const std::vector<Limit>& others) {
        return [&others](const Limit& one) {
            return std::ranges::none_of(others, [&](const Limit& other) { return other.same_hand(one); });
        };
    };
    std::erase_if(without, has_no_partner(with));
    std::erase_if(with, has_no_partner(without));
    if (without.empty() || without.size() != with.size())
        return "";
    const Limit &less = with.front(), &more = with.back();
    const double rises = more.measured / less.measured, bare_rises = without.back().measured / without.front().measured;
    const double share = more.measured / without.back().measured;
    constexpr double kSame = 1.005; // 1
    std::string text =
        fmt::format("Shading the {} {} its limit from {} to {} at {:.4g} N s/m", bare, share < 1 ? "lowers" : "raises",
                    newton_per_metre(without.back().measured), newton_per_metre(more.measured), more.damping);
    if (with.size() > 1)
        text += fmt::format("; from {:.4g} to {:.4g} N s/m it {} with shading, {:.3g} times without{}", less.damping,
                            more.damping,
                            rises < kSame ? std::string("does not rise") : fmt::format("rises {:.3g} times", rises),
                            bare_rises, rises < 0.5 * bare_rises ? ": damping helps little against it" : "");
    return text + "." + grips_of({more});
}

std::string about_delay(const std::vector<Limit>& limits) {
    std::vector<double> left;
    for (const Limit& late : limits)
        if (late.surface == kPlane && late.delay > 0)
            for (const Limit& prompt : limits)
                if (prompt.surface == kPlane && prompt.delay == 0 && prompt.same_hand(late))
                    left.push_back(late.measured / prompt.measured);
    if (left.empty())
        return "";
    return fmt::format(
        "A sample of delay leaves the plane {:.3g} % of its stiffness in the median of {} loops ({:.3g} to "
        "{:.3g} %).",
        100 * median(left), left.size(), 100 * std::ranges::min(left), 100 * std::ranges::max(left));
}

} // namespace

std::vector<Finding> loop_findings(const StudyData& data) {
    const std::vector<Limit> limits = limits_of(data.table("loop_limits"));
    std::vector<Finding> findings;
    add(findings, "loop_scene", about_scene(limits));
    add(findings, "loop_surfaces", about_surfaces(limits));
    add(findings, "loop_shading_bump", about_shading(limits, "bump"));
    add(findings, "loop_delay", about_delay(limits));
    add(findings, "loop_friction", friction_finding(data.table("loop_map")));
    return findings;
}

} // namespace forceshade::study
