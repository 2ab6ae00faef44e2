// Which shading to take: the studies' numbers of each, side by side.
#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <string_view>
#include <tuple>

#include <fmt/format.h>

#include "host/report/sections.h"
#include "host/study/study_data.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::report {
namespace {

using study::StudyData;
using study::Table;

// A shading of the bump of 8 facets or of the mesh of 8 cells, and its names in the studies.
struct Scheme {
    const char *name, *use_when;
    const char *surface, *shading; /* of error-time */
    const char* pressed;           /* of stability */
    const char* energy_name;
};
constexpr double kElements = 8;
constexpr double kDeep = 2e-3; // m: where the largest stable forces are
constexpr Scheme kSchemes[] = {
    {"bump, unshaded", "people should perceive its edges", "bump", "none", "bump of 8 facets", "unshaded"},
    {"bump, reference", "it stands for a cylinder", "bump", "reference", "shaded bump of 8 facets", "shaded"},
    {"mesh, unshaded", "people should perceive its edges", "mesh", "none", "mesh", "unshaded"},
    {"mesh, barycentric", "it stands for a round shape", "mesh", "barycentric", "barycentric mesh", "mean_value"},
    {"mesh, mean_value", "it stands for a round shape, and facets have more than three corners", "mesh", "mean_value",
     "shaded mesh", "mean_value"},
    {"mesh, morgenbesser", "the paper of 1996 is to be repeated", "mesh", "morgenbesser", "morgenbesser mesh",
     "morgenbesser"},
    {"mesh, two_pass", "Ruspini's force (1997) is to be repeated, on blunt edges alone", "mesh", "two_pass",
     "two_pass mesh", "two_pass"}};

static_assert(std::ranges::all_of(kSchemes, [](const Scheme& scheme) {
    return std::ranges::any_of(kStudiedSurfaces,
                               [&](const StudiedSurface& one) { return std::string_view(one.name) == scheme.pressed; });
}));

const StudyData* own_study(const Contents& contents, const char* name) {
    for (const StudyPart& part : contents.studies)
        if (part.data.study == name && part.data.scene.empty())
            return &part.data;
    return nullptr;
}

// The rows of "ways" of a shading in double, of a mesh by the god-object: by the number of elements.
std::map<double, std::size_t> rows_of(const Table& ways, const std::string& surface, const std::string& shading) {
    const std::string family = surface == "mesh" ? "god-object" : "direct";
    std::map<double, std::size_t> rows;
    for (std::size_t row = 0; row < ways.rows.size(); ++row)
        if (ways.word(row, "surface") == surface && ways.word(row, "family") == family &&
            ways.word(row, "precision") == "f64" && ways.word(row, "shading") == shading)
            if (const auto elements = ways.number(row, "elements"))
                rows[*elements] = row;
    return rows;
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

// Whether the machine was too busy for times to be compared.
bool was_busy(const Table& ways) {
    return !ways.rows.empty() && ways.word(0, "busy") == "yes";
}

// N: K times depth at the least limit of the deepest places, of each tessellation, the surface's own first.
std::vector<double> stable_forces(const StudyData& stability, const std::string& surface) {
    std::map<double, double> least;
    for (const Table& limits : stability.tables) {
        const bool anew = limits.name == "loop_tessellations";
        if (!anew && limits.name != "loop_limits")
            continue;
        for (std::size_t row = 0; row < limits.rows.size(); ++row) {
            const double depth = limits.needed(row, "depth_mm"); // mm
            const auto limit = limits.number(row, "any_press_N_per_m");
            if (limits.word(row, "surface") != surface || !(depth > 1) || !limit ||
                (!anew && limits.word(row, "hand") != "own"))
                continue;
            const double force = *limit * 1e-3 * depth;
            double& smallest = least.emplace(anew ? limits.needed(row, "tessellation") : 0, force).first->second;
            smallest = std::min(smallest, force);
        }
    }
    std::vector<double> forces;
    for (const auto& [tessellation, force] : least)
        forces.push_back(force);
    return forces;
}

std::optional<double> gain_of(const StudyData& energy, const Scheme& scheme) {
    const Table& gains = energy.table("energy");
    for (std::size_t row = 0; row < gains.rows.size(); ++row)
        if (gains.word(row, "surface") == scheme.surface && gains.word(row, "scheme") == scheme.energy_name &&
            gains.word(row, "felt") != "god-object" && gains.number(row, "elements") == kElements)
            return gains.number(row, "gain_mJ");
    return std::nullopt;
}

// Rounding is nothing.
std::string shown(std::optional<double> value) {
    return value ? number_text(std::abs(*value) < 1e-6 ? 0 : *value, 2) : "–";
}

// Of some values the first, and the range of all: "2.4 (2.4 to 8.1)".
std::string shown_range(const std::vector<double>& values) {
    if (values.empty())
        return shown({});
    const auto [low, high] = std::ranges::minmax(values);
    const std::string from = shown(low), to = shown(high);
    return shown(values.front()) + (from == to ? "" : fmt::format(" ({} to {})", from, to));
}

std::string percent(double share) {
    return number_text(100 * share, 2);
}

struct Heading {
    const char *words, *unit;
};
constexpr Heading kHeadings[] = {{"error of the direction", "deg RMS (of draws)"},
                                 {"error of the size, median", "% of the force there"},
                                 {"the same, 95th percentile", "% of the force there"},
                                 {"only the smooth shape or the facets have a force", "% of the places"},
                                 {"error of the force, size and direction", "RMS, % of the RMS force"},
                                 {"time of an evaluation", "times unshaded [95 % interval]"},
                                 {"largest stable force K·d", "N, 2 mm deep (of tessellations); 1 N is K = 500 N/m"},
                                 {"energy that a closed stroke gives the hand", "mJ, median"}};

std::string verdict_rows(const StudyData& errors, const StudyData* stability, const StudyData* energy) {
    const Table &ways = errors.table("ways"), &rounds = errors.table("rounds");
    std::string html;
    for (const Scheme& scheme : kSchemes) {
        const auto rows = rows_of(ways, scheme.surface, scheme.shading), plain = rows_of(ways, scheme.surface, "none");
        if (!rows.contains(kElements))
            continue;
        const std::size_t row = rows.at(kElements);
        const std::string low = shown(ways.number(row, "direction_low_deg")),
                          high = shown(ways.number(row, "direction_high_deg"));
        const std::string draws = low == high ? "" : fmt::format(" ({} to {})", low, high);
        std::string time = "1";
        if (plain.contains(kElements) && plain.at(kElements) != row) {
            time = was_busy(ways) ? "not known: the machine was busy"
                                  : study::times_text(time_ratio(rounds, row, plain.at(kElements)));
        }
        const std::string cells[] = {
            fmt::format("{}{}", shown(ways.needed(row, "direction_rms_deg")), draws),
            percent(ways.needed(row, "size_median_1")),
            percent(ways.needed(row, "size_p95_1")),
            percent(ways.needed(row, "one_sided")),
            percent(ways.needed(row, "typical_rms_1")),
            time,
            shown_range(stability ? stable_forces(*stability, scheme.pressed) : std::vector<double>{}),
            shown(energy ? gain_of(*energy, scheme) : std::nullopt)};
        html += fmt::format("<tr><th scope=\"row\">{}</th><td>{}</td>", scheme.name, scheme.use_when);
        for (std::size_t i = 0; i < std::size(cells); ++i) // the heading again, for narrow screens
            html += fmt::format("<td class=\"n\" data-heading=\"{}, {}\">{}</td>", kHeadings[i].words,
                                kHeadings[i].unit, cells[i]);
        html += "</tr>\n";
    }
    return html;
}

// How many facets or cells it takes without shading for a direction within 1 deg, against shading 8; `of` as "{}
// facets".
std::string more_elements(const Table& ways, const Table& rounds, const char* surface, const char* shading,
                          const char* of) {
    const auto plain = rows_of(ways, surface, "none"), shaded = rows_of(ways, surface, shading);
    const auto enough = std::ranges::find_if(
        plain, [&](const auto& one) { return ways.number(one.second, "direction_rms_deg").value_or(NAN) <= 1; });
    if (enough == plain.end() || !shaded.contains(kElements) || enough->first <= kElements)
        return "";
    std::string text = fmt::format(
        "{} unshaded err by {} deg and {} % of the RMS force (both RMS)", fmt::format(fmt::runtime(of), enough->first),
        shown(ways.needed(enough->second, "direction_rms_deg")), percent(ways.needed(enough->second, "typical_rms_1")));
    if (was_busy(ways))
        return text;
    return text + fmt::format(", and take {} times as long as {} shaded",
                              study::times_text(time_ratio(rounds, enough->second, shaded.at(kElements))),
                              fmt::format(fmt::runtime(of), kElements));
}

// What shading takes from the largest stable force: "from 7.9 to 2.3 N on the bump (K from 3950 to 1150 N/m), ...".
std::string fall_of_stable_force(const StudyData& stability) {
    std::string text;
    for (const auto& [plain, shaded, surface] :
         {std::tuple(&kSchemes[0], &kSchemes[1], "bump"), {&kSchemes[2], &kSchemes[3], "mesh"}})
        if (const std::vector<double> before = stable_forces(stability, plain->pressed),
            after = stable_forces(stability, shaded->pressed);
            !before.empty() && !after.empty())
            text += fmt::format("{}from {} to {} N on the {} (K from {:.0f} to {:.0f} N/m)", text.empty() ? "" : ", ",
                                shown_range(before), shown_range(after), surface, before.front() / kDeep,
                                after.front() / kDeep);
    return text;
}

// "goes from 32 to 31 %" or "stays at 100 %".
std::string from_to(const Table& ways, const char* share, std::size_t before, std::size_t after) {
    const std::string from = percent(ways.needed(before, share)), to = percent(ways.needed(after, share));
    return from == to ? fmt::format("stays at {} %", to) : fmt::format("goes from {} to {} %", from, to);
}

// What to take, and what it does.
std::string advice(const Table& ways, const Table& rounds, const StudyData* stability) {
    const auto plain = rows_of(ways, "mesh", "none"), shaded = rows_of(ways, "mesh", "barycentric");
    std::string html = "<p><strong>For a shape that should be perceived as round, shade it: <code>reference</code> on "
                       "a bump, <code>barycentric</code> on a mesh of triangles.</strong></p>\n<ul>\n";
    const auto add = [&](const std::string& item) { html += "<li>" + item + "</li>\n"; };
    const bool known = plain.contains(kElements) && shaded.contains(kElements);
    const auto change = [&](const char* column) {
        return from_to(ways, column, plain.at(kElements), shaded.at(kElements));
    };
    add("Shading mends the direction of the force" +
        (known ? fmt::format(": on the mesh below its error falls from {} to {} deg.",
                             shown(ways.needed(plain.at(kElements), "direction_rms_deg")),
                             shown(ways.needed(shaded.at(kElements), "direction_rms_deg")))
               : "."));
    add("It does not mend its size, which stays that of the facets" +
        (known ? fmt::format(": there the error {} of the force in the median and {} in the 95th percentile, and the "
                             "share of the places where only the mesh or the smooth shape has a force {}",
                             change("size_median_1"), change("size_p95_1"), change("one_sided"))
               : "") +
        ". Only <code>two_pass</code> changes it: it grows by 1/cos of the angle turned, without a bound.");
    if (const std::string forces = stability ? fall_of_stable_force(*stability) : ""; !forces.empty())
        add("<strong>Its price is stability:</strong> 2 mm deep the largest stable force falls " + forces + ".");
    std::string finer;
    for (const std::string& one : {more_elements(ways, rounds, "bump", "reference", "{} facets"),
                                   more_elements(ways, rounds, "mesh", "barycentric", "{0} x {0} cells")})
        if (!one.empty())
            finer += (finer.empty() ? "" : "; ") + one;
    if (!finer.empty())
        add("<strong>If the number of facets is yours to choose, more of them mend direction and size:</strong> " +
            finer + ".");
    return html + "</ul>\n";
}

// The findings of stability that decide whether a device can play it.
std::string on_a_device(const StudyData& stability) {
    std::string html, hand;
    for (const char* name : {"loop_least", "loop_edges"})
        for (const study::Finding& finding : stability.findings)
            if (finding.name == name) {
                html += fmt::format("<li>{}</li>\n", escaped(finding.text));
                hand = hand.empty() ? finding.condition : hand;
            }
    if (html.empty())
        return "";
    return fmt::format("<h3>Is it stable on a device?</h3>\n<ul>\n{}</ul>\n<p class=\"note\">With the {}; its damping "
                       "is {:.3g} N s/m of "
                       "the device and {:.3g} of the grip. Another hand, on each surface: <a href=\"#device\">my "
                       "device</a>; a scene of "
                       "your own: <code>forceshade study stability SCENE</code>.</p>\n",
                       html, escaped(hand), HandSpec{}.damping, HandSpec{}.grip_damping);
}

} // namespace

std::string verdict_section(const Contents& contents) {
    const StudyData *errors = own_study(contents, "error-time"), *stability = own_study(contents, "stability"),
                    *energy = own_study(contents, "energy");
    if (!errors)
        return "";
    std::string rows, text, device;
    try {
        rows = verdict_rows(*errors, stability, energy);
        text = advice(errors->table("ways"), errors->table("rounds"), stability);
        device = stability ? on_a_device(*stability) : "";
    } catch (const study::DataError&) { // of another version
    }
    if (rows.empty())
        return "";
    std::string headings;
    for (const Heading& one : kHeadings)
        headings += fmt::format("<th scope=\"col\" class=\"n\">{} <small>{}</small></th>", one.words, one.unit);
    return "<section id=\"verdict\">\n<h2>Which shading?</h2>\n" + text + surfaces_drawing() +
           "<table>\n<thead><tr><th scope=\"col\">shading</th><th scope=\"col\">take it if</th>" + headings +
           "</tr></thead>\n<tbody>\n" + rows +
           "</tbody>\n</table>\n<details class=\"note\"><summary>What these numbers are of</summary>\n<ul>\n"
           "<li>All are of the paper's bump, R = 15.24 mm and W = 25.4 mm, K = 1000 N/m: of 8 facets, and as a mesh of "
           "8 "
           "x 8 cells.</li>\n"
           "<li>Errors are against the smooth cylinder, 0.02 to 2 mm under it: of the bump with 2 mm of the plane on "
           "either side, whose normal is the one above the probe, as shading takes it; of the mesh for |x| &lt; 9 mm, "
           "whose normal is the nearest.</li>\n"
           "<li>Facets lie below the cylinder, so that a light touch misses them. The errors of direction and size "
           "leave "
           "such places out; in the last error the whole force is missing there.</li>\n"
           "<li>Times are of single evaluations, on the mesh of a god-object's updates.</li>\n"
           "<li>A force is stable if small displacements die out, with the hand below, at every place 2 mm deep where "
           "the direction does not jump. The hand presses in any direction that the surface supports with a fifth of "
           "its "
           "force and of a wall's stiffness; further aside the limit may fall to 0.</li>\n"
           "<li>Energies are of the static force, also on the mesh, along strokes out and back at another depth.</li>\n"
           "<li>(a to b): the least and the largest of draws of places, grids and meshes. [a, b]: a 95 % interval, "
           "alone "
           "where the ratio may be 1.</li>\n</ul></details>\n" +
           device + "</section>\n";
}

} // namespace forceshade::report
