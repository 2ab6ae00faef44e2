#include "host/experiment/perception.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/experiment/analysis.h"
#include "host/experiment/stroke.h"

namespace forceshade::experiment {
namespace {

using study::Cell;

constexpr double kClose = 5; // percentage points
constexpr unsigned kMostFacets = 128;

struct Expected {
    const Case* one = nullptr;
    Shares stroked{};            /* of a simulated hand's strokes */
    std::optional<Shares> rigid; /* of a bump, in the rigid limit */
    bool tested = false;         /* in 1996 */
};

bool is_bump(const Case& one) {
    return one.scene.surface.kind == SurfaceKind::bump || one.scene.surface.kind == SurfaceKind::cylinder_bump;
}

std::optional<Shares> rigid_shares(const Case& one) {
    if (!is_bump(one))
        return std::nullopt;
    const SurfaceSpec& surface = one.scene.surface;
    const unsigned facets = surface.kind == SurfaceKind::bump ? surface.facets : 0;
    return shares_of(rigid_signals(surface.radius, surface.width, facets, one.scene.force.shading != Shading::none),
                     {});
}

// Of Table 2: one of its stimuli, at one of its radii.
bool is_tested(const Case& one) {
    const double mil = one.scene.surface.radius / kMil;
    return is_bump(one) && !paper_name(one).empty() &&
           std::ranges::any_of(std::array{600.0, 1000.0, 1400.0},
                               [&](double radius) { return std::abs(radius - mil) < 0.01; });
}

study::Table expected_table(const std::vector<Expected>& rows) {
    using R = Expected;
    std::vector<study::ColumnOf<R>> columns{
        {{"case", "", "scene"}, [](const R& r) { return Cell(r.one->name); }},
        {{"tested", "", "whether it was a stimulus of 1996, to which the observer was fitted"},
         [](const R& r) { return Cell(r.tested ? "tested in 1996" : "never tested"); }}};
    for (std::size_t i = 0; i < kPictures; ++i)
        columns.push_back(
            {{fmt::format("{}_percent", kPictureNames[i]), "%", "answers expected of a simulated hand's strokes"},
             [i](const R& r) { return Cell(100 * r.stroked[i]); }});
    for (std::size_t i = 0; i < kPictures; ++i)
        columns.push_back({{fmt::format("{}_rigid_percent", kPictureNames[i]), "%",
                            "answers expected in the limit of a rigid surface; of bumps alone"},
                           [i](const R& r) { return r.rigid ? Cell(100 * (*r.rigid)[i]) : Cell(); }});
    columns.push_back({{"moved_points", "%", "how far the scene's stiffness moves the answers from the rigid limit"},
                       [](const R& r) { return r.rigid ? Cell(apart(r.stroked, *r.rigid)) : Cell(); }});
    return study::table_of<R>("answers", "Answers that the observer expects", columns, rows);
}

struct Needed {
    double radius, width; /* m */
    bool shaded;
    std::optional<unsigned> facets;
};

// For each radius and width among the bumps.
std::vector<Needed> facets_needed(const std::vector<Expected>& rows) {
    std::set<std::pair<double, double>> shapes;
    for (const Expected& row : rows)
        if (is_bump(*row.one))
            shapes.insert({row.one->scene.surface.radius, row.one->scene.surface.width});
    std::vector<Needed> needed;
    for (const auto& [radius, width] : shapes)
        for (const bool shaded : {false, true})
            needed.push_back({radius, width, shaded, facets_within(kClose, radius, width, shaded)});
    return needed;
}

study::Table needed_table(const std::vector<Needed>& needed) {
    using R = Needed;
    return study::table_of<R>(
        "facets", "Facets from which on the answers are those of the cylinder",
        {{{"radius_mm", "mm", "of the cylinder"}, [](const R& r) { return Cell(1e3 * r.radius); }},
         {{"width_mm", "mm", "of the bump"}, [](const R& r) { return Cell(1e3 * r.width); }},
         {{"shading", "", "of the bump"}, [](const R& r) { return Cell(r.shaded ? "shaded" : "unshaded"); }},
         {{"facets", "1",
           fmt::format("fewest within {} percentage points, in the limit of a rigid surface; nothing: more than {}",
                       kClose, kMostFacets)},
          [](const R& r) { return r.facets ? Cell(*r.facets) : Cell(); }}},
        needed);
}

void add_findings(study::StudyData& data, const std::vector<Expected>& rows, const std::vector<Needed>& needed) {
    std::vector<std::string> bare, shaded;
    for (const Needed& one : needed)
        if (one.facets)
            (one.shaded ? shaded : bare).push_back(fmt::format("{} (R = {:.3g} mm)", *one.facets, 1e3 * one.radius));
    if (!bare.empty() && !shaded.empty())
        data.findings.push_back({"facets",
                                 fmt::format("A model fitted to bumps of one to three facets expects the cylinder's "
                                             "answers, within {} percentage points, "
                                             "from {} facets on unshaded and {} shaded.",
                                             kClose, fmt::join(bare, ", "), fmt::join(shaded, ", ")),
                                 "facets", "bumps of this width",
                                 "the limit of a rigid surface, the observer's published parameters",
                                 "a model's expectation: more than three facets were never tested"});
    const Expected* most = nullptr;
    for (const Expected& row : rows)
        if (row.rigid && (!most || apart(row.stroked, *row.rigid) > apart(most->stroked, *most->rigid)))
            most = &row;
    if (most)
        data.findings.push_back(
            {"stiffness",
             fmt::format(
                 "The scenes' stiffness moves the expected answers from those of a rigid surface by up to {:.0f} "
                 "percentage points.",
                 apart(most->stroked, *most->rigid)),
             "answers", most->one->name,
             "a hand that strokes at 0.1 m/s and presses 1 N, unless the scene says otherwise",
             "a model's expectation"});
}

} // namespace

double apart(const Shares& one, const Shares& other) {
    double sum = 0;
    for (std::size_t i = 0; i < kPictures; ++i)
        sum += std::abs(one[i] - other[i]);
    return 50 * sum;
}

std::optional<unsigned> facets_within(double points, double radius, double width, bool shaded,
                                      const ObserverParameters& observer) {
    const Shares round = shares_of(rigid_signals(radius, width, 0, false), observer);
    for (unsigned facets = kMostFacets; facets >= 1; --facets)
        if (apart(shares_of(rigid_signals(radius, width, facets, shaded), observer), round) > points)
            return facets < kMostFacets ? std::optional(facets + 1) : std::nullopt;
    return 1;
}

study::StudyData study_perception(study::StudyRun& run) {
    const Study own = default_study();
    const std::vector<Case>& cases = run.options().cases.empty() ? own.cases : run.options().cases;
    std::vector<Expected> rows;
    std::vector<std::string> left_out;
    std::vector<study::Part> parts;
    CasePreparation preparation;
    for (const Case& one : cases)
        parts.push_back({one.name, [&] {
                             const PreparedCase stimulus = preparation.prepare(one);
                             const auto passes =
                                 passes_over(feature_of(stimulus), stroke(stimulus, manner_of(one.scene)));
                             if (passes.empty())
                                 left_out.push_back(one.name);
                             else
                                 rows.push_back({&one, answer_shares(passes, {}), rigid_shares(one), is_tested(one)});
                         }});
    run.run(parts);
    if (rows.empty())
        throw UsageError("no scene was crossed by a whole stroke in contact, so that there is nothing to answer to");
    const std::vector<Needed> needed = facets_needed(rows);
    study::StudyData data = run.data();
    data.tables = {expected_table(rows), needed_table(needed)};
    study::Figure facets;
    facets.name = "facets";
    facets.title = "Facets that feel round";
    facets.caption =
        fmt::format("Fewest facets whose answers stay within {} percentage points of the cylinder's, as the observer "
                    "expects them of a rigid surface.",
                    kClose);
    facets.table = "facets";
    facets.x = {"radius_mm", "radius / mm"};
    facets.y = {"facets", "facets"};
    facets.series = "shading";
    facets.joined = true;
    study::Figure answers;
    answers.name = "answers";
    answers.title = "Answers \"round\" that the observer expects";
    answers.caption = "Of a simulated hand's strokes over each scene.";
    answers.kind = study::FigureKind::bars;
    answers.table = "answers";
    answers.x = {"case", "scene"};
    answers.y = {"cylinder_percent", "answers \"round\" / %"};
    answers.series = "tested";
    data.figures = {facets, answers};
    if (needed.empty())
        data.figures.erase(data.figures.begin());
    data.notes = {
        "The observer was fitted to the 21 stimuli of 1996 (column tested) and its structure chosen with them in "
        "sight. Of other surfaces, facets, radii, depths and stiffnesses nobody knows yet how people answer.",
        "Answers are the paper's four pictures: flat, two facets, three facets, cylinder."};
    if (!left_out.empty())
        data.notes.push_back(
            fmt::format("No whole stroke stayed in contact with {}; left out.", fmt::join(left_out, ", ")));
    add_findings(data, rows, needed);
    return data;
}

} // namespace forceshade::experiment
