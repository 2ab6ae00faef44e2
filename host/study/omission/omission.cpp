#include "host/study/omission/omission.h"

#include <fmt/format.h>

#include "host/error.h"
#include "host/study/omission/measurement.h"
#include "host/study/omission/omission_findings.h"
#include "host/study/omission/tables.h"
#include "host/study/omission/touched.h"

namespace forceshade::study {
namespace {

using Json = nlohmann::ordered_json;

constexpr unsigned kRounds = 15, kQuickRounds = 7;
constexpr double kRoundSeconds = 0.1, kQuickRoundSeconds = 0.01; // s
constexpr double kBudget = 6, kQuickBudget = 1;                  // s: of a comparison

std::string step_name(const Comparison& one) {
    std::string name = one.scene + "." + one.feature;
    std::ranges::replace(name, ' ', '_');
    return name;
}

// A scene whose samples are all free has no feature that matters: that leaving it out changes nothing would be said of
// nothing, and all times would be those of free space.
Touched require_contact(StudyRun& run, const BaseScene& base) {
    const std::vector<Json> results =
        run.run_steps({{"contact", [&] {
                            const Touched samples = touched(run.engine(), base);
                            return Json{{"field", samples.field}, {"paths", samples.paths}};
                        }}});
    const Touched samples{results[0].at("field"), results[0].at("paths")};
    if (samples.field == 0 && samples.paths == 0)
        throw UsageError(
            fmt::format("nothing of the scene's {} is in contact: every feature could be left out, and the "
                        "study would compare zeros with zeros; let it reach below the surface",
                        !base.paths  ? "[grid]"
                        : base.field ? "[grid] and [paths]"
                                     : "[paths]"));
    return samples;
}

// Where the grid touches nothing but the paths do, or the other way round.
void add_free_note(const BaseScene& base, const Touched& samples, StudyData& data) {
    const auto add = [&](const char* what) {
        data.notes.push_back(fmt::format("Nothing of the scene's {} is in contact: what is told of it is what free "
                                         "space takes, and that it stays free.",
                                         what));
    };
    if (base.field && samples.field == 0)
        add("[grid]");
    if (base.paths && samples.paths == 0)
        add("[paths]");
}

void add_notes(const std::vector<BaseScene>& scenes, unsigned rounds, StudyData& data) {
    for (const BaseScene& base : scenes) {
        const auto& size = base.prepared.one.scene.grid.size;
        data.notes.push_back(
            base.field ? fmt::format("{}: {}, {} x {} x {} voxels.", base.name, base.about, size[0], size[1], size[2])
                       : fmt::format("{}: {}.", base.name, base.about));
    }
    data.notes.push_back(
        fmt::format("Each ratio is the median of {} rounds, fewer where they take long; in each both "
                    "sides were evaluated in turn, in shuffled order, again and again where that takes "
                    "but a moment, and the least times count. Spreads are quartiles.",
                    rounds));
    data.notes.push_back("Every y and free space are always left out where a scene permits; the study alone evaluates "
                         "them, and no scene can ask for it. What makes a field depend on y (proxies, a Gaussian, an "
                         "image) is switched at every y on both sides, so that it is switched alone.");
    data.notes.push_back("The feature \"nothing\" is a control: both sides are the same, and what lies between them is "
                         "the measurement's own.");
}

} // namespace

StudyData study_omission(StudyRun& run) {
    const bool quick = run.options().quick;
    const unsigned rounds = quick ? kQuickRounds : kRounds;
    const double seconds = quick ? kQuickRoundSeconds : kRoundSeconds;
    const std::vector<BaseScene> scenes =
        run.scene() ? std::vector{user_scene(*run.scene(), quick)} : own_scenes(quick);
    const Touched samples = run.scene() ? require_contact(run, scenes.front()) : Touched();
    std::vector<Comparison> comparisons;
    for (const BaseScene& base : scenes)
        for (Comparison& one : comparisons_of(base, !run.options().engine.cpu))
            comparisons.push_back(std::move(one));
    std::vector<Step> steps;
    for (std::size_t i = 0; i < comparisons.size(); ++i)
        steps.push_back({step_name(comparisons[i]), [&, i] {
                             return measure(run.engine(), comparisons[i],
                                            {rounds, seconds, quick ? kQuickBudget : kBudget, 1 + i},
                                            run.options().folder);
                         }});
    const std::vector<Json> results = run.run_steps(steps);
    StudyData data = run.data();
    data.tables = {features_table(comparisons, results), omitted_table(scenes, comparisons)};
    data.figures = omission_figures(data.tables.front());
    add_notes(scenes, rounds, data);
    if (run.scene())
        add_free_note(scenes.front(), samples, data);
    data.findings = omission_findings(data);
    return data;
}

} // namespace forceshade::study
