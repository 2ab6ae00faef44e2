// Which shading to take: the studies' numbers of each, side by side.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <span>

#include <fmt/format.h>

#include "host/report/sections.h"
#include "host/report/words.h"
#include "host/study/data/medians.h"

namespace forceshade::report {
namespace {

using study::StudyData;
using study::Table;

// A scheme, and its names in the studies.
struct Scheme {
    const char *name, *use_when;
    const char *surface, *shading;     /* of error-time */
    const char *felt_on, *energy_name; /* of stability, of energy */
};
constexpr Scheme kSchemes[] = {
    {"bump, unshaded", "its edges should be felt", "bump", "none", "bump", "unshaded"},
    {"bump, shaded", "it stands for a cylinder", "bump", "reference", "shaded bump", "shaded"},
    {"mesh, unshaded", "its edges should be felt", "mesh", "none", "mesh", "unshaded"},
    {"mesh, mean_value", "it should feel round", "mesh", "mean_value", "shaded mesh", "mean_value"},
    {"mesh, morgenbesser", "the paper is to be repeated", "mesh", "morgenbesser", "", "morgenbesser"},
    {"mesh, two_pass", "all of its edges are blunt", "mesh", "two_pass", "", "two_pass"}};

// The elements whose errors are shown, for the coarse surfaces that shading is for.
constexpr std::pair<const char*, double> kElements[] = {{"bump", 16}, {"mesh", 8}};
constexpr std::pair<const char*, double> kEnergyElements[] = {{"bump", 8}, {"mesh", 16}};

double elements_of(std::span<const std::pair<const char*, double>> list, const std::string& surface) {
    return std::ranges::find(list, surface, [](const auto& one) { return std::string(one.first); })->second;
}

const StudyData* own_study(const Contents& contents, const char* name) {
    for (const StudyPart& part : contents.studies)
        if (part.data.study == name && part.data.scene.empty())
            return &part.data;
    return nullptr;
}

// The row of the scheme in "ways", in double; of a mesh the god-object's.
std::optional<std::size_t> way_of(const Table& ways, const Scheme& scheme) {
    const std::string surface = scheme.surface, family = surface == "mesh" ? "god-object" : "direct";
    for (std::size_t row = 0; row < ways.rows.size(); ++row)
        if (ways.word(row, "surface") == surface && ways.word(row, "family") == family &&
            ways.word(row, "precision") == "f64" && ways.word(row, "shading") == scheme.shading &&
            ways.number(row, "elements") == elements_of(kElements, surface))
            return row;
    return std::nullopt;
}

// Of two rows of "ways", in the same rounds.
study::Interval time_ratio(const Table& rounds, std::size_t way, std::size_t other) {
    std::map<double, std::pair<double, double>> times;
    for (std::size_t row = 0; row < rounds.rows.size(); ++row) {
        const double of = rounds.needed(row, "way");
        if (of != double(way + 1) && of != double(other + 1))
            continue;
        auto& [one, two] = times[rounds.needed(row, "round")];
        (of == double(way + 1) ? one : two) = rounds.needed(row, "time_ns");
    }
    std::vector<double> ratios;
    for (const auto& [round, pair] : times)
        ratios.push_back(pair.first / pair.second);
    return study::bootstrap_median(ratios);
}

// N: K times depth at the least limit of the deepest places; empty: not studied.
std::optional<double> stable_force(const StudyData& stability, const std::string& surface) {
    const Table& limits = stability.table("loop_limits");
    std::optional<double> least;
    for (std::size_t row = 0; row < limits.rows.size(); ++row)
        if (limits.word(row, "surface") == surface && limits.word(row, "hand") == "own")
            if (const auto limit = limits.number(row, "limit_N_per_m")) {
                const double force = *limit * 1e-3 * limits.needed(row, "depth_mm");
                if (limits.needed(row, "depth_mm") > 1 && (!least || force < *least))
                    least = force;
            }
    return least;
}

std::optional<double> gain_of(const StudyData& energy, const Scheme& scheme) {
    const Table& gains = energy.table("energy");
    for (std::size_t row = 0; row < gains.rows.size(); ++row)
        if (gains.word(row, "surface") == scheme.surface && gains.word(row, "scheme") == scheme.energy_name &&
            gains.word(row, "felt") != "god-object" &&
            gains.number(row, "elements") == elements_of(kEnergyElements, scheme.surface))
            return gains.number(row, "gain_mJ");
    return std::nullopt;
}

// Rounding is nothing.
std::string shown(double value) {
    return number_text(std::abs(value) < 1e-6 ? 0 : value, 2);
}

std::string verdict_rows(const Contents& contents) {
    const StudyData *errors = own_study(contents, "error-time"), *stability = own_study(contents, "stability"),
                    *energy = own_study(contents, "energy");
    if (!errors)
        return "";
    const Table &ways = errors->table("ways"), &rounds = errors->table("rounds");
    std::string rows;
    for (const Scheme& scheme : kSchemes) {
        const auto way = way_of(ways, scheme);
        if (!way)
            continue;
        Scheme plain = scheme;
        plain.shading = "none";
        const auto base = way_of(ways, plain);
        std::string time = "1";
        if (base && base != way) {
            const study::Interval ratio = time_ratio(rounds, *way, *base);
            time = study::is_significant(ratio)
                       ? fmt::format("{:.2f} [{:.2f}, {:.2f}]", ratio.median, ratio.low, ratio.high)
                       : fmt::format("no difference [{:.2f}, {:.2f}]", ratio.low, ratio.high);
        }
        const auto force = stability ? stable_force(*stability, scheme.felt_on) : std::nullopt;
        const auto gain = energy ? gain_of(*energy, scheme) : std::nullopt;
        rows += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td><td "
                            "class=\"n\">{}</td>"
                            "<td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n",
                            scheme.name, scheme.use_when, shown(ways.needed(*way, "direction_rms_deg")),
                            fmt::format("{} ({})", number_text(100 * ways.needed(*way, "local_median_1"), 2),
                                        number_text(100 * ways.needed(*way, "local_p95_1"), 2)),
                            time, force ? number_text(*force, 2) : "–", gain ? shown(*gain) : "–");
    }
    return rows;
}

} // namespace

std::string verdict_section(const Contents& contents) {
    std::string rows;
    try {
        rows = verdict_rows(contents);
    } catch (const study::DataError&) { // of another version
    }
    if (rows.empty())
        return "";
    return "<section id=\"verdict\">\n<h2>Which shading?</h2>\n" + surfaces_drawing() +
           "<div class=\"wide\" tabindex=\"0\" role=\"region\" "
           "aria-label=\"Which shading?\"><table>\n<thead><tr><th scope=\"col\">scheme</th><th scope=\"col\">take it "
           "when</th><th scope=\"col\" class=\"n\">error of the direction <small>deg RMS</small></th><th "
           "scope=\"col\" class=\"n\">error of the force <small>% of it, median (95 %)</small></th><th scope=\"col\" "
           "class=\"n\">time <small>of unshaded</small></th><th scope=\"col\" class=\"n\">largest stable force K·d "
           "<small>N, 2 mm deep</small></th><th scope=\"col\" class=\"n\">energy given <small>mJ a "
           "loop</small></th></tr></thead>\n<tbody>\n" +
           rows +
           "</tbody>\n</table></div>\n<p class=\"note\">Shading mends the direction, not the size of the force, which "
           "stays that of the facets. Errors: a bump of 16 facets and a mesh of 8 cells over the width, where a hand "
           "touches; stability: the default hand at 1 kHz on a bump of 2 facets and a mesh of 8 cells; energy: 8 "
           "facets and 16 cells.</p>\n</section>\n";
}

} // namespace forceshade::report
