// Results of the loops as tables, figures and findings.
#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/study/energy/energy.h"

namespace forceshade::study {
namespace {

constexpr double kLeastShown = 1e-6; // mJ: smaller values are drawn there on logarithmic axes

bool same_surface(const EnergyLaw& one, const EnergyLaw& other) {
    return one.surface == other.surface && one.elements == other.elements &&
           one.prepared->one.scene.force.depth == other.prepared->one.scene.force.depth;
}

// The same loop on the same surface unshaded; null: none.
const LoopRow* unshaded_of(const std::vector<LoopRow>& loops, const LoopRow& row) {
    for (const LoopRow& one : loops)
        if (one.law->unshaded && one.history == row.history && one.number == row.number &&
            same_surface(*one.law, *row.law))
            return &one;
    return nullptr;
}

// The columns that identify a row's law, then `more`.
template <typename Row> std::vector<ColumnOf<Row>> law_columns(std::initializer_list<ColumnOf<Row>> more) {
    std::vector<ColumnOf<Row>> columns{
        {"surface", "", "bump: R = 600 mil, W = 1000 mil; mesh: its cylinder as triangles; scene: the scene's",
         [](const Row& row) { return row.law->surface; }},
        {"elements", "1", "facets of the bump, cells of the mesh over its width",
         [](const Row& row) { return row.law->elements; }},
        {"scheme", "", "shading, and the depth reading if not vertical",
         [](const Row& row) { return row.law->scheme; }},
        {"felt", "", "by the place: the force depends on the position only; god-object: with its history",
         [](const Row& row) { return row.history ? "god-object" : "by the place"; }}};
    columns.insert(columns.end(), more);
    return columns;
}

Table law_table(const std::vector<LawRow>& laws) {
    using R = LawRow;
    const auto more = [](double Interval::*end) {
        return [end](const R& r) { return r.more ? 1e3 * (*r.more).*end : NAN; };
    };
    return table_of<R>(
        "energy", "Energy gained per closed stroke",
        law_columns<R>(
            {{"series", "", "scheme, and god-object if with its history",
              [](const R& r) { return r.law->scheme + (r.history ? ", god-object" : ""); }},
             {"closed_strokes", "1", "that stay in contact", &R::loops},
             {"gain_mJ", "mJ",
              "energy gained per closed stroke in the worse direction of travel: median of the closed strokes",
              [](const R& r) { return 1e3 * r.gain.median; }},
             {"gain_from_mJ", "mJ", "95 % interval of the median (bootstrap)",
              [](const R& r) { return 1e3 * r.gain.low; }},
             {"gain_to_mJ", "mJ", "the other end", [](const R& r) { return 1e3 * r.gain.high; }},
             {"gain_5_mJ", "mJ", "5 % of the closed strokes give less", [](const R& r) { return 1e3 * r.low; }},
             {"gain_95_mJ", "mJ", "5 % of the closed strokes give more", [](const R& r) { return 1e3 * r.high; }},
             {"effort_mJ", "mJ", "the integral of |F dl|: median of the closed strokes",
              [](const R& r) { return 1e3 * r.effort; }},
             {"more_mJ", "mJ", "gain less that of the same closed stroke unshaded: median", more(&Interval::median)},
             {"more_from_mJ", "mJ", "95 % interval of that (bootstrap)", more(&Interval::low)},
             {"more_to_mJ", "mJ", "the other end", more(&Interval::high)},
             {"shown_mJ", "mJ", "gain_mJ, at least 1e-6 for logarithmic axes",
              [](const R& r) { return std::max(1e3 * r.gain.median, kLeastShown); }},
             {"shown_5_mJ", "mJ", "gain_5_mJ, at least 1e-6",
              [](const R& r) { return std::max(1e3 * r.low, kLeastShown); }},
             {"shown_95_mJ", "mJ", "gain_95_mJ, at least 1e-6",
              [](const R& r) { return std::max(1e3 * r.high, kLeastShown); }}}),
        laws);
}

Table loop_table(const std::vector<LoopRow>& loops) {
    using R = LoopRow;
    return table_of<R>(
        "closed_strokes", "Every closed stroke",
        law_columns<R>({{"stroke", "1", "which stroke", &R::number},
                        {"gain_mJ", "mJ", "energy gained in the worse direction of travel",
                         [](const R& r) { return 1e3 * r.gain; }},
                        {"effort_mJ", "mJ", "the integral of |F dl|", [](const R& r) { return 1e3 * r.effort; }}}),
        loops);
}

// Those of the figure: of the bump with 8 facets, or of the scene.
Table pair_table(const std::vector<LoopRow>& loops) {
    struct R {
        const LoopRow *row, *unshaded;
    };
    std::vector<R> rows;
    for (const LoopRow& row : loops) {
        const bool shown = row.law->surface == "scene" || (row.law->surface == "bump" && row.law->elements == 8);
        if (!row.history && shown && !row.law->unshaded)
            if (const LoopRow* unshaded = unshaded_of(loops, row))
                rows.push_back({&row, unshaded});
    }
    return table_of<R>("pairs", "Shaded against unshaded, stroke by stroke",
                       {{"scheme", "", "shading, and the depth reading if not vertical",
                         [](const R& r) { return r.row->law->scheme; }},
                        {"stroke", "1", "which stroke", [](const R& r) { return r.row->number; }},
                        {"unshaded_mJ", "mJ", "gain of this closed stroke unshaded",
                         [](const R& r) { return 1e3 * r.unshaded->gain; }},
                        {"gain_mJ", "mJ", "its gain with shading", [](const R& r) { return 1e3 * r.row->gain; }}},
                       rows);
}

Table stroke_table(const EnergyResults& results) {
    struct R {
        std::string surface;
        std::size_t number;
        Stroke stroke;
    };
    std::vector<R> rows;
    for (const EnergySurface& surface : results.surfaces)
        for (std::size_t i = 0; i < surface.strokes.size(); ++i)
            rows.push_back({surface.name, i, surface.strokes[i]});
    return table_of<R>("strokes", "Where the closed strokes go",
                       {{"surface", "", "below which", &R::surface},
                        {"stroke", "1", "which stroke", &R::number},
                        {"from_x_mm", "mm", "where it begins", [](const R& r) { return 1e3 * r.stroke.from.x; }},
                        {"from_y_mm", "mm", "where it begins", [](const R& r) { return 1e3 * r.stroke.from.y; }},
                        {"to_x_mm", "mm", "where it turns", [](const R& r) { return 1e3 * r.stroke.to.x; }},
                        {"to_y_mm", "mm", "where it turns", [](const R& r) { return 1e3 * r.stroke.to.y; }},
                        {"out_mm", "mm", "depth on the way out, vertically below the facets",
                         [](const R& r) { return 1e3 * r.stroke.out; }},
                        {"back_mm", "mm", "depth on the way back", [](const R& r) { return 1e3 * r.stroke.back; }}},
                       rows);
}

Table curl_table(const std::vector<CurlCell>& cells) {
    using R = CurlCell;
    return table_of<R>("curl", "Curl of the force in a section, over the stiffness",
                       {{"section", "", "surface and scheme", &R::section},
                        {"x_mm", "mm", "middle of the cell", [](const R& r) { return 1e3 * r.x; }},
                        {"z_mm", "mm", "middle of the cell", [](const R& r) { return 1e3 * r.z; }},
                        {"curl_per_K", "1", "work round it over its area and K: the mean of 8 x 8 cells of samples",
                         &R::curl_per_stiffness}},
                       cells);
}

Figure law_figure(const EnergySurface& surface) {
    return make_figure("energy-" + surface.name, fmt::format("Energy gained per closed stroke on the {}", surface.name),
                       "Median of the closed strokes, with whiskers from 5 to 95 % of them, worse direction of travel.",
                       FigureKind::scatter, "energy", {{"surface", surface.name}, {"felt", "by the place"}},
                       {"elements", fmt::format("{} over the width", surface.elements), true},
                       {"shown_mJ", "gain / mJ", true}, "series", "",
                       {.low = "shown_5_mJ", .high = "shown_95_mJ", .joined = true});
}

bool any_shaded(const EnergyResults& results) {
    return std::ranges::any_of(results.laws, [](const LawRow& row) { return row.more.has_value(); });
}

std::vector<Figure> figures_of(const EnergyResults& results) {
    std::vector<Figure> figures;
    for (const EnergySurface& surface : results.surfaces)
        if (!surface.elements.empty())
            figures.push_back(law_figure(surface));
    if (any_shaded(results))
        figures.push_back(make_figure("energy-pairs", "Shaded against unshaded, stroke by stroke",
                                      "Each point is a closed stroke; on the diagonal shading has no effect.",
                                      FigureKind::scatter, "pairs", {}, {"unshaded_mJ", "gain unshaded / mJ"},
                                      {"gain_mJ", "gain shaded / mJ"}, "scheme"));
    if (!results.curl.empty())
        figures.push_back(make_figure(
            "curl", "Where closed strokes give energy, in a section",
            "Work round a cell over its area and K; a closed stroke gives the sum of the cells inside it. Along a jump "
            "of the force, alternating colours cancel.",
            FigureKind::cells, "curl", {}, {"x_mm", "x / mm"}, {"z_mm", "z / mm"}, "", "",
            {.value = "curl_per_K", .value_label = "curl_y F / K", .value_limit = 0.5, .panels = "section"}));
    return figures;
}

std::string interval_of(const LawRow& row) {
    return fmt::format("{} closed strokes; 95 % of bootstrap medians: {:.2g} to {:.2g} mJ; 5 to 95 % of closed "
                       "strokes: {:.2g} to {:.2g} mJ",
                       row.loops, 1e3 * row.gain.low, 1e3 * row.gain.high, 1e3 * row.low, 1e3 * row.high);
}

const LawRow* row_of_law(const EnergyResults& results, const std::string& surface, std::optional<double> elements,
                         const std::string& scheme, bool history = false) {
    for (const LawRow& row : results.laws)
        if (row.law->surface == surface && row.law->elements == elements && row.law->scheme == scheme &&
            row.history == history)
            return &row;
    return nullptr;
}

const char* const kWhere = "strokes anywhere on the surface, 0.2 to 2 mm deep out and back, K = 1000 N/m";

// The gain with the most facets, where only the depth reading makes the force differ from that of a spring.
void add_depth_finding(std::vector<Finding>& findings, const EnergyResults& results) {
    constexpr double kFacets = 512;
    const LawRow *vertical = row_of_law(results, "bump", kFacets, "unshaded"),
                 *normal = row_of_law(results, "bump", kFacets, "unshaded, normal depth");
    if (!vertical || !normal)
        return;
    findings.push_back({"energy_depth",
                        fmt::format("More facets do not remove the gain: with {} facets, unshaded, it is {}; with "
                                    "depth read along the normal, {}.",
                                    kFacets, milli(vertical->gain.median), milli(normal->gain.median)),
                        "energy-bump", "the bump of 512 facets, R = 600 mil", kWhere,
                        fmt::format("vertical: {}; normal: {}", interval_of(*vertical), interval_of(*normal))});
}

// Gains of a mesh in ascending order, and neighbours without a significant difference on the same loops.
void add_mesh_finding(std::vector<Finding>& findings, const EnergyResults& results) {
    constexpr double kCells = 16;
    std::vector<const LawRow*> rows;
    for (const char* scheme : {"unshaded", "morgenbesser", "mean_value", "two_pass"})
        if (const LawRow* row = row_of_law(results, "mesh", kCells, scheme))
            rows.push_back(row);
    if (rows.empty())
        return;
    std::ranges::stable_sort(rows, {}, [](const LawRow* row) { return row->gain.median; });
    const auto significantly_different = [&](const LawRow& one, const LawRow& other) {
        std::vector<double> more;
        for (const LoopRow& a : results.loops)
            for (const LoopRow& b : results.loops)
                if (a.law == one.law && b.law == other.law && !a.history && !b.history && a.number == b.number)
                    more.push_back(a.gain - b.gain);
        return is_significant(bootstrap_median(more), 0);
    };
    std::vector<std::string> parts, intervals, ties;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        parts.push_back(fmt::format("{} {}", rows[i]->law->scheme, milli(rows[i]->gain.median)));
        intervals.push_back(fmt::format("{} {:.2g} to {:.2g} mJ", rows[i]->law->scheme, 1e3 * rows[i]->gain.low,
                                        1e3 * rows[i]->gain.high));
        if (i > 0 && !significantly_different(*rows[i - 1], *rows[i]))
            ties.push_back(fmt::format("{} and {}", rows[i - 1]->law->scheme, rows[i]->law->scheme));
    }
    findings.push_back(
        {"energy_mesh",
         fmt::format("Median energy gained per closed stroke on a mesh of {} cells over the bump: {}{}.", kCells,
                     fmt::join(parts, ", "),
                     ties.empty() ? "" : fmt::format("; no significant difference between {}", fmt::join(ties, ", "))),
         "energy-mesh", "triangles of the cylinder R = 600 mil, tessellated anew", kWhere,
         fmt::format("95 % of bootstrap medians: {}", fmt::join(intervals, ", "))});
}

void add_own_findings(std::vector<Finding>& findings, const EnergyResults& results) {
    const LawRow *bare = row_of_law(results, "bump", 8, "unshaded"), *shaded = row_of_law(results, "bump", 8, "shaded");
    if (bare && shaded && shaded->more)
        findings.push_back(
            {"energy_shading",
             fmt::format("Force shading adds {} per closed stroke on the 8-facet bump (median of the paired "
                         "differences, worse direction of travel; median gains with and without shading: {} and {}).",
                         milli(shaded->more->median), milli(shaded->gain.median), milli(bare->gain.median)),
             "energy-bump", "the bump of 8 facets, R = 600 mil", kWhere,
             fmt::format("{} closed strokes; 95 % of bootstrap medians of the difference: {:.2g} to {:.2g} mJ; efforts "
                         "{} and {}",
                         shaded->loops, 1e3 * shaded->more->low, 1e3 * shaded->more->high, milli(shaded->effort),
                         milli(bare->effort))});
    std::vector<std::string> parts;
    std::optional<double> significant; // facets: the most with a significant difference
    const LawRow* last = nullptr;
    for (const LawRow& row : results.laws) {
        if (row.law->surface != "bump" || row.law->scheme != "shaded" || !row.more)
            continue;
        last = &row;
        if (is_significant(*row.more, 0))
            significant = row.law->elements;
        if (*row.law->elements == 1 || *row.law->elements == 2 || *row.law->elements == 8)
            parts.push_back(fmt::format("{:.2g} mJ with {}", 1e3 * row.more->median, *row.law->elements));
    }
    if (last && !parts.empty())
        findings.push_back(
            {"energy_facets",
             fmt::format(
                 "On the same closed strokes, the gain that shading adds falls with the number of facets: {}{}.",
                 fmt::join(parts, ", "),
                 significant && *significant < *last->law->elements
                     ? fmt::format("; beyond {} facets it is not significant", *significant)
                     : ""),
             "energy-bump", "the bump of 1 to 512 facets, R = 600 mil", kWhere,
             fmt::format("with {} facets 95 % of bootstrap medians: {:.1g} to {:.1g} mJ", *last->law->elements,
                         1e3 * last->more->low, 1e3 * last->more->high)});
    add_depth_finding(findings, results);
    add_mesh_finding(findings, results);
}

void add_scene_findings(std::vector<Finding>& findings, const EnergyResults& results) {
    std::vector<std::string> parts;
    const LawRow* most = nullptr;
    for (const LawRow& row : results.laws)
        if (!row.history) {
            parts.push_back(fmt::format("{} {}", row.law->scheme, milli(row.gain.median, row.effort)));
            most = !most || row.gain.median > most->gain.median ? &row : most;
        }
    if (!most)
        return;
    findings.push_back(
        {"energy_scene",
         fmt::format("Median energy gained per closed stroke over the scene's surface: {}; the effort is {}.",
                     fmt::join(parts, ", "), milli(most->effort, most->effort)),
         any_shaded(results) ? "energy-pairs" : "", "strokes anywhere in the scene's region",
         fmt::format("{:.2g} to {:.2g} mm deep out and back", 1e2 * results.surfaces[0].region.deepest,
                     1e3 * results.surfaces[0].region.deepest),
         fmt::format("{}: {}", most->law->scheme, interval_of(*most))});
}

// Energy gained per loop with the god-object's history, by the cells of the mesh.
void add_history_finding(std::vector<Finding>& findings, const EnergyResults& results) {
    std::vector<std::string> unshaded, shaded;
    const LawRow *first = nullptr, *most = nullptr; // shaded: the scheme that gives most on the first mesh
    for (const LawRow& row : results.laws)
        if (row.history && !row.law->unshaded && (!most || most->law->elements == row.law->elements) &&
            (!most || row.gain.median > most->gain.median))
            most = &row;
    for (const LawRow& row : results.laws) {
        if (!row.history || !most || (!row.law->unshaded && row.law->scheme != most->law->scheme))
            continue;
        (row.law->unshaded ? unshaded : shaded)
            .push_back(fmt::format("{:.2g} mJ{}", 1e3 * row.gain.median,
                                   row.law->elements ? fmt::format(" with {} cells", *row.law->elements) : ""));
        first = first ? first : &row;
    }
    if (unshaded.empty() || shaded.empty())
        return;
    findings.push_back(
        {"energy_history",
         fmt::format("Median energy gained per closed stroke with the god-object, unshaded: {}; with {}: {}.",
                     fmt::join(unshaded, ", "), most->law->scheme, fmt::join(shaded, ", ")),
         "", first->law->elements ? "meshes of the cylinder R = 600 mil, tessellated anew" : "the scene's mesh",
         "the second round, worse direction of travel",
         fmt::format("{}: {}", first->law->scheme, interval_of(*first))});
}

} // namespace

std::string milli(double joules, double effort) {
    const double rounding = 1e-6 * effort;
    return std::abs(joules) < rounding ? fmt::format("less than {:.1g} mJ", 1e3 * rounding)
                                       : fmt::format("{:.2g} mJ", 1e3 * joules);
}

std::vector<LawRow> summarise_by_law(const std::vector<LoopRow>& loops) {
    std::vector<LawRow> laws;
    for (const LoopRow& first : loops) {
        if (std::ranges::any_of(
                laws, [&](const LawRow& row) { return row.law == first.law && row.history == first.history; }))
            continue;
        std::vector<double> gains, efforts, more;
        for (const LoopRow& row : loops)
            if (row.law == first.law && row.history == first.history) {
                gains.push_back(row.gain);
                efforts.push_back(row.effort);
                if (const LoopRow* bare = row.law->unshaded ? nullptr : unshaded_of(loops, row))
                    more.push_back(row.gain - bare->gain);
            }
        laws.push_back({first.law, first.history, gains.size(), bootstrap_median(gains), quantile(gains, 0.05),
                        quantile(gains, 0.95), quantile(efforts, 0.5),
                        more.empty() ? std::nullopt : std::optional(bootstrap_median(more))});
    }
    std::ranges::stable_sort(laws, {}, &LawRow::history);
    return laws;
}

void add_energy(StudyData& data, const EnergyResults& results) {
    data.tables = {law_table(results.laws), pair_table(results.loops), stroke_table(results), loop_table(results.loops),
                   curl_table(results.curl)};
    data.figures = figures_of(results);
    data.notes = {
        "A closed stroke is a stroke out between two places anywhere in the region, up or down to another "
        "depth, back below the same line, and to where it began; depths are log-uniform over a decade and "
        "vertical below the facets. The same strokes go over all laws of a surface; on the study's own meshes "
        "they take turns with tessellations that are turned and moved at random.",
        "The energy gained per closed stroke is that of the worse direction of travel. Where the force "
        "depends on the position only, the other direction loses as much; with the god-object's history both "
        "directions were travelled twice, and the second round counts.",
        "Where the force depends on the position only, work is summed by Simpson's rule, steps halved at a "
        "jump down to rounding error; with history it is the mean of neighbouring forces times the step. "
        "All is in double precision by the CPU oracle."};
    if (data.scene.empty())
        add_own_findings(data.findings, results);
    else
        add_scene_findings(data.findings, results);
    add_history_finding(data.findings, results);
    add_renderers(data, results.renderers);
}

} // namespace forceshade::study
