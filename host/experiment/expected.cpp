#include "host/experiment/analysis.h"

#include <algorithm>
#include <cmath>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/error.h"
#include "host/experiment/run.h"
#include "host/experiment/statistics.h"
#include "host/experiment/stroke.h"
#include "host/random.h"
#include "host/scene/value.h"
#include "host/spelling.h"

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
        data.findings.push_back(
            {"facets",
             fmt::format("A model fitted to bumps of one to three facets expects the cylinder's answers, within {} "
                         "percentage points, from {} facets upwards unshaded and from {} shaded.",
                         kClose, fmt::join(bare, ", "), fmt::join(shaded, ", ")),
             "facets", "bumps of this width", "the limit of a rigid surface, the observer's published parameters",
             "a model's expectation: more than three facets were never tested"});
    const Expected* most = nullptr;
    for (const Expected& row : rows)
        if (row.rigid && (!most || apart(row.stroked, *row.rigid) > apart(most->stroked, *most->rigid)))
            most = &row;
    if (most)
        data.findings.push_back({"stiffness",
                                 fmt::format("The scenes' stiffness moves the expected answers from those of a rigid "
                                             "surface by up to {:.0f} percentage points.",
                                             apart(most->stroked, *most->rigid)),
                                 "answers", most->one->name,
                                 "a hand that strokes at 0.1 m/s and presses 1 N, unless the scene says otherwise",
                                 "a model's expectation"});
}

constexpr double kPower = 0.8;

const Case& condition_named(const Experiment& experiment, const std::string& name) {
    std::vector<std::string> names;
    for (const Case& one : experiment.study.cases) {
        if (one.name == name)
            return one;
        names.push_back(one.name);
    }
    throw UsageError("--compare: no condition \"{}\"{}; there are {}", name, did_you_mean(name, names),
                     fmt::join(names, ", "));
}

Shares expected_answers(const Case& stimulus) {
    return answer_shares(passes_of(CasePreparation().prepare(stimulus)), {});
}

} // namespace

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
                             const auto passes = passes_of(preparation.prepare(one));
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
    study::Figure facets = study::make_figure(
        "facets", "Facets that feel round",
        fmt::format("Fewest facets whose answers stay within {} percentage points of the cylinder's, as the observer "
                    "expects them of a rigid surface.",
                    kClose),
        study::FigureKind::scatter, "facets", {}, {"radius_mm", "radius / mm"}, {"facets", "facets"}, "shading");
    facets.joined = true;
    if (!needed.empty())
        data.figures.push_back(facets);
    data.figures.push_back(study::make_figure("answers", "Answers \"round\" that the observer expects",
                                              "Of a simulated hand's strokes over each scene.", study::FigureKind::bars,
                                              "answers", {}, {"case", "scene"},
                                              {"cylinder_percent", "answers \"round\" / %"}, "tested"));
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

double power_of(double first, double second, unsigned trials, unsigned subjects) {
    constexpr unsigned kExperiments = 1000;
    constexpr double kSignificant = 0.05;
    if (subjects < kLeastSubjects)
        return 0;
    Random random(1, fmt::format("{} {} {} {}", first, second, trials, subjects));
    const BetaBinomial of_first(first, kSubjectCorrelation, trials), of_second(second, kSubjectCorrelation, trials);
    unsigned found = 0;
    for (unsigned i = 0; i < kExperiments; ++i) {
        std::vector<double> differences;
        differences.reserve(subjects);
        for (unsigned subject = 0; subject < subjects; ++subject)
            differences.push_back(double(of_first(random)) - double(of_second(random)));
        found += sign_flip_p(differences) <= kSignificant;
    }
    return static_cast<double>(found) / kExperiments;
}

Plan planned(const Experiment& experiment, const std::string& first, const std::string& second) {
    if (experiment.spec.task == Task::compare)
        throw UsageError("plan is for task = \"name\"; run a comparison with --participant observer and analyse that");
    make_observer(experiment); // refuses other answers
    const Shares a = expected_answers(condition_named(experiment, first)),
                 b = expected_answers(condition_named(experiment, second));
    std::size_t most = 0;
    for (std::size_t i = 1; i < kPictures; ++i)
        if (std::abs(a[i] - b[i]) > std::abs(a[most] - b[most]))
            most = i;
    Plan plan{first, second, experiment.spec.answers[most].label, a[most], b[most], {}};
    for (const unsigned trials : {6u, 12u, 24u, 48u}) {
        // The fewest: power grows with the subjects but for the noise of its simulation, and few are simulated faster.
        const auto enough = [&](unsigned subjects) { return power_of(a[most], b[most], trials, subjects) >= kPower; };
        unsigned low = kLeastSubjects - 1, high = kLeastSubjects;
        bool any = enough(high);
        for (; !any && high < kMostSubjects; any = enough(high)) {
            low = high;
            high = std::min(2 * high, kMostSubjects);
        }
        while (any && low + 1 < high) {
            const unsigned middle = (low + high) / 2;
            (enough(middle) ? high : low) = middle;
        }
        plan.needed.push_back({trials, any ? std::optional(high) : std::nullopt});
    }
    return plan;
}

std::vector<std::pair<std::string, std::string>> natural_pairs(const Experiment& experiment) {
    std::vector<std::pair<std::string, std::string>> pairs;
    for (const Case& shaded : experiment.study.cases) {
        Scene bare = shaded.scene;
        bare.force.shading = Shading::none;
        for (const Case& other : experiment.study.cases)
            if (shaded.scene.force.shading != Shading::none && other.scene == bare)
                pairs.emplace_back(shaded.name, other.name);
    }
    return pairs;
}

} // namespace forceshade::experiment
