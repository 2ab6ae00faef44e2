// Which shading to take: the studies' numbers of each, side by side, under a drawing of what the studies press: a bump
// of facets, cut across, and the forces on it, unshaded and shaded.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <optional>

#include <fmt/format.h>

#include "host/report/sections.h"
#include "host/study/study_data.h"

namespace forceshade::report {
namespace {

using study::StudyData;
using study::Table;

// A scheme, and its names in the studies.
struct Scheme {
    const char *name, *use_when;
    const char *surface, *shading;     /* of error-time */
    const char *felt_on, *energy_name; /* of stability, of energy */
    double elements, energy_elements;  /* whose errors and whose energy are shown: coarse surfaces, as shading is for */
};
constexpr Scheme kSchemes[] = {
    {"bump, unshaded", "its edges should be felt", "bump", "none", "bump", "unshaded", 16, 8},
    {"bump, shaded", "it stands for a cylinder", "bump", "reference", "shaded bump", "shaded", 16, 8},
    {"mesh, unshaded", "its edges should be felt", "mesh", "none", "mesh", "unshaded", 8, 16},
    {"mesh, mean_value", "it should feel round", "mesh", "mean_value", "shaded mesh", "mean_value", 8, 16},
    {"mesh, morgenbesser", "the paper of 1996 is to be repeated", "mesh", "morgenbesser", "morgenbesser mesh",
     "morgenbesser", 8, 16},
    {"mesh, two_pass", "all of its edges are blunt", "mesh", "two_pass", "two_pass mesh", "two_pass", 8, 16}};

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
            ways.number(row, "elements") == scheme.elements)
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
    ratios.reserve(times.size());
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
            gains.word(row, "felt") != "god-object" && gains.number(row, "elements") == scheme.energy_elements)
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
            time = study::is_significant(ratio) ? study::ratio_text(ratio)
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

constexpr double kHalf = 12.7, kRadius = 25.4; /* mm: the paper's width, and the radius of the studies' bump */
constexpr int kFacets = 5;
constexpr double kScale = 10, kBorder = 4; /* px/mm, mm */
constexpr double kArrow = 30, kHead = 5;   /* px */
constexpr double kGround = 78, kHeight = 88, kWidth = 2 * (kHalf + kBorder) * kScale;

struct Place {
    double x, y; // px
};

double arc_height(double x) {
    const double deep = std::sqrt(kRadius * kRadius - kHalf * kHalf);
    return std::abs(x) < kHalf ? std::sqrt(kRadius * kRadius - x * x) - deep : 0;
}
double vertex(int i) {
    const double half = std::asin(kHalf / kRadius); // by equal arcs
    return kRadius * std::sin(half * (2.0 * i / kFacets - 1));
}
Place place_at(double x, double z) {
    return {(x + kHalf + kBorder) * kScale, kGround - z * kScale};
}

std::string line_to(const char* command, Place place) {
    return fmt::format("{}{:.1f},{:.1f}", command, place.x, place.y);
}

// From the surface outwards; `x` and `z` of a unit vector.
std::string arrow(Place from, double x, double z) {
    const Place tip{from.x + kArrow * x, from.y - kArrow * z};
    const auto barb = [&](double side) {
        return Place{tip.x - kHead * (x + 0.6 * side * z), tip.y + kHead * (z - 0.6 * side * x)};
    };
    return line_to("M", from) + line_to("L", tip) + line_to("M", barb(1)) + line_to("L", tip) + line_to("L", barb(-1));
}

// `direction`: of the force at x on the facet from `left` to `right`, x over z.
using Direction = std::function<double(double x, double left, double right)>;

std::string panel(const std::string& words, const Direction& direction) {
    std::string facets = line_to("M", place_at(-kHalf - kBorder, 0)), smooth, forces;
    for (int i = 0; i <= kFacets; ++i)
        facets += line_to("L", place_at(vertex(i), arc_height(vertex(i))));
    facets += line_to("L", place_at(kHalf + kBorder, 0));
    for (int i = 0; i <= 40; ++i) {
        const double x = kHalf * (i / 20.0 - 1);
        smooth += line_to(i == 0 ? "M" : "L", place_at(x, arc_height(x)));
    }
    for (int i = 0; i < kFacets; ++i)
        for (const double share : {1 / 6.0, 0.5, 5 / 6.0}) {
            const double left = vertex(i), right = vertex(i + 1), x = left + share * (right - left);
            const double z = arc_height(left) + share * (arc_height(right) - arc_height(left));
            const double tilt = direction(x, left, right), size = std::hypot(1, tilt);
            forces += arrow(place_at(x, z), tilt / size, 1 / size);
        }
    // Readers of HTML know the attribute by its small letters, too.
    return fmt::format(
        "<figure class=\"surface\"><svg viewbox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"><path class=\"smooth\" "
        "d=\"{}\"></path><path class=\"facets\" d=\"{}\"></path><path class=\"forces\" d=\"{}\"></path></svg>"
        "<figcaption>{}</figcaption></figure>\n",
        kWidth, kHeight, words, smooth, facets, forces, words);
}

std::string surfaces_drawing() {
    return "<div class=\"surfaces\">\n" +
           panel("unshaded: the force jumps from facet to facet",
                 [](double, double left, double right) {
                     return (arc_height(left) - arc_height(right)) / (right - left);
                 }) +
           panel("shaded: as large, and turned to the smooth shape (dashed)",
                 [](double x, double, double) { return x / std::sqrt(kRadius * kRadius - x * x); }) +
           "</div>\n";
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
           "scope=\"col\" class=\"n\">error of the force <small>% of it, median (95 % of places below)</small></th><th "
           "scope=\"col\" "
           "class=\"n\">time <small>of unshaded</small></th><th scope=\"col\" class=\"n\">largest stable force K·d "
           "<small>N, 2 mm deep</small></th><th scope=\"col\" class=\"n\">energy given to the hand <small>mJ a "
           "loop</small></th></tr></thead>\n<tbody>\n" +
           rows +
           "</tbody>\n</table></div>\n<p class=\"note\">Shading mends the direction, not the size of the force, which "
           "stays that of the facets. Errors: a bump of 16 facets and a mesh of 8 cells over the width, where a hand "
           "touches; stability: the default hand at 1 kHz on a bump of 2 facets and a mesh of 8 cells; energy: 8 "
           "facets and 16 cells. In brackets: 95 % intervals.</p>\n</section>\n";
}

} // namespace forceshade::report
