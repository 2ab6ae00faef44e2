#include "host/study/energy/tables.h"

#include <algorithm>
#include <cmath>
#include <map>

#include <fmt/format.h>

#include "host/study/data/rows.h"
#include "host/study/energy/scenes.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kComparedRadius = 1000; /* mil */
constexpr double kLeastError = 1e-3;     /* deg: shown in place of less */
constexpr double kLeastEta = 1e-5;       /* likewise */

const std::vector<Column> kLoopColumns{
    {"surface", "", "Surface of the loop."},
    {"group", "",
     "Schemes that figures show together: of the bump's own facets, of meshes by the nearest place, of "
     "meshes by the god-object."},
    {"scheme", "", "How force is made of the surface; rows of one scheme differ in facets and radius."},
    {"law", "", "The scheme, whatever its history."},
    {"history", "", "static field: force follows from the place alone; god-object: from the way there, too."},
    {"loop", "",
     "half: from the middle to one side; whole: from side to side, where a symmetric surface gives back what "
     "it takes."},
    {"facets", "1", "Facets of the bump, or cells of the mesh over its width; none: smooth."},
    {"radius_mil", "mil", "Radius of the cylinder."},
    {"stiffness_N_per_m", "N/m", "K."},
    {"out_mm", "mm", "Depth d1 on the way out, vertical, below the surface that the loop follows."},
    {"back_mm", "mm", "Depth d2 on the way back."},
    {"work_mJ", "mJ", "Work on the probe out at depth d1 and back at d2; a mean over the lines of a mesh."},
    {"work_back_mJ", "mJ", "Work the other way about: its opposite but for laws with a history."},
    {"gained_mJ", "mJ", "The greater of the two: what a hand can gain each round."},
    {"effort_mJ", "mJ", "Integral of |F dl| round the loop."},
    {"eta", "1", "Gained energy over effort."},
    {"closed_form_mJ", "mJ", "The work in closed form, where there is one."},
    {"closed_form_difference", "1", "Difference between work and closed form, over the effort."},
    {"engine_work_mJ", "mJ", "The work as the engine adds it up from sample to sample."},
    {"engine_difference", "1", "Difference between the engine's work and work_mJ, over the effort."},
    {"unfinished_samples", "1", "Samples at which a proxy did not come to rest."},
    {"direction_rms_deg", "deg",
     "Direction of the force against the smooth shape's normal above the place of contact, "
     "root mean square along the loop."},
    {"direction_largest_deg", "deg", "The largest such angle."},
    {"error_shown_deg", "deg", "direction_rms_deg, but no less than 0.001, for logarithmic axes."},
    {"eta_shown", "1", "The size of eta, but no less than 1e-5, for logarithmic axes."}};

/// Printed in the laws: rows of one scheme with these facets, one value for each of the paper's radii.
struct Printed {
    const char* law;
    const char* scheme;
    unsigned facets; /* 0: any; the row with the most */
    const char* column;
    double values[3];
    double tolerance;
};

const Printed kPrinted[] = {
    {"flat shaded plane, work", "shaded", 1, "work_mJ", {2.3061, 1.4841, 1.0823}, 5e-5},
    {"height map on the plane, work", "height map on the plane", 0, "work_mJ", {2.3061, 1.4841, 1.0823}, 5e-5},
    {"two_pass on the plane, work", "plane mesh two_pass", 0, "work_mJ", {3.398, 1.698, 1.170}, 5e-4},
    {"plane and cylinder superposed, work", "superposed", 0, "work_mJ", {0, 0, 0}, 1e-9},
    {"unshaded plane, work", "facets", 1, "work_mJ", {0, 0, 0}, 1e-9},
    {"flat shaded plane, eta", "shaded", 1, "eta", {0.25, 0.24, 0.22}, 5e-3}};

bool is_row(const Table& loops, std::size_t row, const std::string& scheme, unsigned facets, double radius) {
    const auto radius_here = loops.number(row, "radius_mil");
    const auto facets_here = loops.number(row, "facets");
    return loops.word(row, "scheme") == scheme && radius_here && std::abs(*radius_here - radius) < 1e-6 &&
           (facets == 0 || (facets_here && *facets_here == facets));
}

/// Of all unshaded bumps, how far work is from the sum over their breaks, in mJ.
void add_breaks(const Table& loops, Table& laws) {
    for (const char* scheme : {"facets", "facets, normal depth"})
        for (const double radius : kPaperRadii) {
            double off = 0;
            bool any = false;
            for (std::size_t row = 0; row < loops.rows.size(); ++row)
                if (const auto work = loops.number(row, "work_mJ"), sum = loops.number(row, "closed_form_mJ");
                    work && sum && is_row(loops, row, scheme, 0, radius)) {
                    off = std::max(off, std::abs(*work - *sum));
                    any = true;
                }
            if (any)
                laws.rows.push_back({fmt::format("breaks of {}, difference from their sum in mJ", scheme), radius, 0.0,
                                     off, 1e-9, std::string(off <= 1e-9 ? "yes" : "no")});
        }
}

/// A loop over a real surface.
struct Point {
    double facets, error, eta;
};

struct SchemeErrors {
    std::string name, group;
    std::vector<Point> points;
};

/// Of each scheme at the compared radius, in the order of their rows, those with facets.
std::vector<SchemeErrors> schemes_of(const Table& loops) {
    std::vector<SchemeErrors> schemes;
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const auto error = loops.number(row, "direction_rms_deg"), eta = loops.number(row, "eta"),
                   facets = loops.number(row, "facets"), radius = loops.number(row, "radius_mil");
        if (!error || !eta || !facets || !radius || std::abs(*radius - kComparedRadius) > 1e-6 ||
            loops.word(row, "surface") == "plane as mesh")
            continue;
        const std::string name = loops.word(row, "scheme");
        auto found = std::ranges::find(schemes, name, &SchemeErrors::name);
        if (found == schemes.end())
            found = schemes.insert(found, {name, loops.word(row, "group"), {}});
        found->points.push_back({*facets, *error, *eta});
    }
    return schemes;
}

/// The one with the fewest facets whose error is at most `level`; none between two of them is made up, for energy may
/// go from taken to given on the way.
std::optional<Point> coarsest(const std::vector<Point>& points, double level) {
    std::optional<Point> found;
    for (const Point& point : points)
        if (point.error <= level && (!found || point.facets < found->facets))
            found = point;
    return found;
}

/// Errors that most of the schemes keep to with some of their facets.
constexpr double kLevels[] = {2, 1, 0.5, 0.2}; /* deg */

constexpr std::string_view kGodObject = ", god-object"; /* at the end of a scheme's name */

std::string group_of(const std::string& surface, const std::string& scheme) {
    if (surface.find("mesh") == std::string::npos)
        return kGroups[0];
    return scheme.ends_with(kGodObject) ? kGroups[2] : kGroups[1];
}

} // namespace

Table loops_table(const std::vector<Json>& rows) {
    Table table{"loops", "Work round loops below the surface", kLoopColumns, {}};
    for (Json row : rows) {
        if (row.contains("direction_rms_deg"))
            row["error_shown_deg"] = std::max(kLeastError, row["direction_rms_deg"].get<double>());
        const std::string scheme = row.at("scheme");
        row["group"] = group_of(row.at("surface"), scheme);
        const bool history = scheme.ends_with(kGodObject);
        row["law"] = scheme.substr(0, scheme.size() - (history ? kGodObject.size() : 0));
        row["history"] = history ? "god-object" : "static field";
        row["eta_shown"] = std::max(kLeastEta, std::abs(row["eta"].get<double>()));
        table.rows.push_back(row_of(kLoopColumns, row));
    }
    return table;
}

Table laws_table(const Table& loops) {
    Table table{"laws",
                "What the laws print, reproduced",
                {{"law", "", "What is printed."},
                 {"radius_mil", "mil", "Radius of the cylinder."},
                 {"printed", "mJ or 1", "The printed value."},
                 {"found", "mJ or 1", "The value found by this study."},
                 {"tolerance", "mJ or 1", "Half the last printed digit, or what rounding leaves of 0."},
                 {"holds", "", "Whether the two agree within the tolerance."}},
                {}};
    for (const Printed& printed : kPrinted)
        for (int i = 0; i < 3; ++i)
            for (std::size_t row = 0; row < loops.rows.size(); ++row) {
                if (!is_row(loops, row, printed.scheme, printed.facets, kPaperRadii[i]))
                    continue;
                const auto found = loops.number(row, printed.column);
                const bool holds = found && std::abs(*found - printed.values[i]) <= printed.tolerance;
                table.rows.push_back({std::string(printed.law), kPaperRadii[i], printed.values[i],
                                      found ? Cell(*found) : Cell(), printed.tolerance,
                                      std::string(holds ? "yes" : "no")});
            }
    add_breaks(loops, table);
    return table;
}

Table equal_error_table(const Table& loops) {
    Table table{"equal_error",
                "Energy of the coarsest surface that keeps to a direction error, bump of 1000 mil",
                {{"error_deg", "deg", "The direction error to keep to, root mean square."},
                 {"group", "", "Bump or meshes, as in loops."},
                 {"scheme", "", "How force is made of the surface."},
                 {"facets", "1",
                  "Facets of the bump, or cells of the mesh, over its width: the fewest in loops with which the scheme "
                  "has no more than this error."},
                 {"direction_rms_deg", "deg", "The direction error that it has with them."},
                 {"eta", "1", "Gained energy over effort with them."}},
                {}};
    const std::vector<SchemeErrors> schemes = schemes_of(loops);
    for (const double level : kLevels)
        for (const SchemeErrors& scheme : schemes)
            if (const auto point = coarsest(scheme.points, level))
                table.rows.push_back({level, scheme.group, scheme.name, point->facets, point->error, cell(point->eta)});
    return table;
}

Table front_table(const Table& loops) {
    Table table{"front",
                "Loops that no other beats in both direction error and energy, bump of 1000 mil",
                {{"scheme", "", "How force is made of the surface."},
                 {"facets", "1", "Facets over the bump's width; none: smooth."},
                 {"error_shown_deg", "deg", "Direction error, root mean square, no less than 0.001."},
                 {"eta_shown", "1", "Size of gained energy over effort, no less than 1e-5."}},
                {}};
    struct Candidate {
        std::size_t row;
        double error, eta;
    };
    std::vector<Candidate> all;
    for (std::size_t row = 0; row < loops.rows.size(); ++row) {
        const auto radius = loops.number(row, "radius_mil"), error = loops.number(row, "error_shown_deg"),
                   eta = loops.number(row, "eta_shown");
        if (radius && error && eta && std::abs(*radius - kComparedRadius) < 1e-6 &&
            loops.word(row, "surface") != "plane as mesh")
            all.push_back({row, *error, *eta});
    }
    std::ranges::stable_sort(all, {}, [](const Candidate& one) { return std::pair(one.error, one.eta); });
    double least = std::numeric_limits<double>::infinity();
    for (const Candidate& one : all) {
        if (!(one.eta < least))
            continue;
        least = one.eta;
        table.rows.push_back({loops.word(one.row, "scheme"),
                              loops.number(one.row, "facets") ? Cell(*loops.number(one.row, "facets")) : Cell(),
                              one.error, one.eta});
    }
    return table;
}

// A map of thousands of cells is for looking at: digits that are rounding's own, or of no cell's place, stay out of it.
Cell rounded(double value, double steps) {
    return cell(std::round(value * steps) / steps + 0.0);
}

Table curl_table(const std::vector<Json>& maps) {
    Table table{"curl",
                "Curl of the force in sections of x and z",
                {{"map", "", "Which section."},
                 {"x_mm", "mm", "Across the bump."},
                 {"z_mm", "mm", "Up; the plane is z = 0."},
                 {"curl_per_K", "1",
                  "curl_y F = dF_x/dz - dF_z/dx over the stiffness, a mean over a cell of the map, to 1e-9."}},
                {}};
    for (const Json& map : maps)
        for (const Json& one : map.at("cells"))
            table.rows.push_back({map.at("map").get<std::string>(), rounded(1e3 * one[0].get<double>(), 1e6),
                                  rounded(1e3 * one[1].get<double>(), 1e6), rounded(one[2].get<double>(), 1e9)});
    return table;
}

Table curl_maps_table(const std::vector<Json>& maps) {
    Table table{"curl_maps",
                "How much curl a field has",
                {{"map", "", "Which section."},
                 {"scheme", "", "Whose force it is, as in loops."},
                 {"spacing_mm", "mm", "Between samples of the field along x."},
                 {"cell_mm", "mm", "Width of a cell of the map, whose curl is the work round it over its area."},
                 {"largest_per_K", "1",
                  "Largest size of a cell's curl_y over the stiffness; a jump of the force along a line has it spread "
                  "over the cell's width, so that this grows as cells shrink."},
                 {"mean_per_K", "1",
                  "Mean size of curl_y over the stiffness, of the map's cells in contact; jumps along lines count by "
                  "their length, however wide cells are."},
                 {"sampling_per_K", "1",
                  "Mean size of what the cells' curl_y changes by where every second sample of the field is left out, "
                  "over the stiffness: a mean_per_K that is not above it is sampling's own, at jumps of the force "
                  "across lines that samples do not follow."},
                 {"closed_form_difference_per_K", "1", "Largest difference from the closed form, where there is one."}},
                {}};
    for (const Json& map : maps)
        table.rows.push_back(row_of(table.columns, map));
    return table;
}

} // namespace forceshade::study
