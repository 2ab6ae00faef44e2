#include "host/study/error_time/error_time.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/study/error_time/error_time_findings.h"
#include "host/study/error_time/measured.h"
#include "host/study/error_time/patch_rows.h"
#include "host/study/run/quartiles.h"

namespace forceshade::study {
namespace {

using namespace error_time;
using Json = nlohmann::ordered_json;

constexpr std::size_t kComparedAtOnce = 6; // contenders
constexpr std::size_t kWarmedAtOnce = 12;  // contenders
constexpr std::size_t kLookupPlaces = 8000;

// Steps, and who takes what they give.
struct Plan {
    std::vector<Step> steps;
    std::vector<std::function<void(const Json&)>> takers;

    void add(const std::string& name, std::function<Json()> compute, std::function<void(const Json&)> take) {
        steps.push_back({name, std::move(compute)});
        takers.push_back(std::move(take));
    }
};

std::vector<Subject> subjects_of(const StudyRun& run, const Extents& extents) {
    if (run.scene())
        return {scene_subject(*run.scene(), extents)};
    std::vector<Subject> subjects;
    subjects.push_back(bump_subject(extents));
    subjects.push_back(mesh_subject(extents));
    return subjects;
}

// The law whose reference<double> is the unit of time: the one that most is done with.
std::string unit_name(const Subject& subject) {
    for (const Variant& variant : subject.variants)
        if (variant.lookups)
            return reference_name(subject, variant);
    return reference_name(subject, subject.variants.front());
}

void warm_up(const Contender& contender, std::vector<bool>& warm, std::size_t number) {
    if (!warm[number])
        contender.seconds();
    warm[number] = true;
}

Json compare(const Contender& contender, const SmoothLaw& smooth) {
    const Evaluated evaluated = contender.evaluate();
    std::vector<glm::dvec3> truth;
    if (contender.smooth)
        truth = contender.smooth(evaluated.at);
    else
        for (const glm::dvec3& at : evaluated.at)
            truth.push_back(smooth(at));
    return {{"smooth", to_json(force_errors(evaluated.force, truth))},
            {"reference", to_json(force_errors(evaluated.force, contender.exact(evaluated.at)))}};
}

const Subject& subject_named(const std::vector<Subject>& subjects, const std::string& name) {
    return *std::find_if(subjects.begin(), subjects.end(), [&](const Subject& one) { return one.name == name; });
}

void plan_errors(Plan& plan, const std::vector<Subject>& subjects, Measured& measured) {
    measured.compared.resize(measured.contenders.size());
    for (std::size_t first = 0; first < measured.contenders.size(); first += kComparedAtOnce) {
        const std::size_t end = std::min(first + kComparedAtOnce, measured.contenders.size());
        plan.add(
            fmt::format("errors-{:02}", first / kComparedAtOnce),
            [&, first, end] {
                Json all = Json::array();
                for (std::size_t i = first; i < end; ++i) {
                    const Contender& one = measured.contenders[i];
                    all.push_back(compare(one, subject_named(subjects, one.subject).smooth));
                }
                return all;
            },
            [&, first](const Json& all) {
                for (std::size_t i = 0; i < all.size(); ++i)
                    measured.compared[first + i] = {errors_from(all[i].at("smooth")),
                                                    errors_from(all[i].at("reference"))};
            });
    }
}

void plan_patches(Plan& plan, const Extents& extents, Measured& measured) {
    for (std::size_t mesh = 0; mesh < patch_meshes(); ++mesh)
        plan.add(
            fmt::format("patch-{}", mesh), [mesh] { return to_json(patch_rows(mesh)); },
            [&](const Json& json) {
                for (PatchRow& row : patch_rows_from(json))
                    measured.patches.push_back(std::move(row));
            });
    constexpr std::array<double, 4> kExpected{1, 1, 2, 2};
    const std::size_t before = measured.series.size();
    for (std::size_t i = 0; i < kExpected.size(); ++i)
        measured.series.push_back({fmt::format("patch of triangles, {}", kPatchShadings[i]),
                                   "direction RMS / deg",
                                   "1 / cells",
                                   {},
                                   {},
                                   kExpected[i],
                                   "L7"});
    for (const unsigned cells : extents.cells)
        if (cells >= 8)
            plan.add(
                fmt::format("patch-order-{}", cells), [cells] { return Json(patch_rms(cells)); },
                [&measured, before, cells](const Json& rms) {
                    for (std::size_t i = 0; i < rms.size(); ++i) {
                        measured.series[before + i].sizes.push_back(1.0 / cells);
                        measured.series[before + i].errors.push_back(rms[i]);
                    }
                });
}

void plan_lookups(Plan& plan, const Extents& extents, Measured& measured) {
    for (const LookupCase& one : lookup_cases())
        for (const double spacing : extents.spacings) {
            if (spacing > one.coarsest)
                continue;
            plan.add(
                fmt::format("lookup-{}-{:.0f}um", one.short_name, spacing * 1e6),
                [one, spacing] { return to_json(lookup_errors(one, spacing, kLookupPlaces)); },
                [&measured, one, spacing](const Json& json) {
                    for (const LookupError& error : lookup_errors_from(json))
                        measured.lookups.push_back(
                            {one.name, spacing, error, expected_order(one, error.method, error.place)});
                });
        }
}

// Each contender once, so that nothing is compiled or made within a round; in steps of their own, as that takes longer.
void plan_warming(Plan& plan, const Measured& measured, const std::shared_ptr<std::vector<bool>>& warm) {
    warm->resize(measured.contenders.size());
    for (std::size_t first = 0; first < warm->size(); first += kWarmedAtOnce)
        plan.add(
            fmt::format("warm-{:02}", first / kWarmedAtOnce),
            [&measured, warm, first] {
                for (std::size_t i = first; i < std::min(first + kWarmedAtOnce, warm->size()); ++i)
                    warm_up(measured.contenders[i], *warm, i);
                return Json();
            },
            [](const Json&) {});
}

void plan_rounds(Plan& plan, const Extents& extents, bool quick, Measured& measured) {
    const std::size_t at_once = quick ? 1 : 4;
    const auto warm = std::make_shared<std::vector<bool>>();
    plan_warming(plan, measured, warm);
    for (std::size_t first = 0; first < extents.rounds; first += at_once)
        plan.add(
            fmt::format("time-{:02}", first / at_once),
            [&measured, warm, first, at_once] {
                for (std::size_t i = 0; i < warm->size(); ++i) // what an earlier run warmed is cold
                    warm_up(measured.contenders[i], *warm, i);
                Json rounds = Json::array();
                for (std::size_t i = 0; i < at_once; ++i)
                    rounds.push_back(to_json(measure_round(measured.contenders, measured.unit, first + i)));
                return rounds;
            },
            [&](const Json& rounds) {
                for (const Json& round : rounds)
                    measured.rounds.push_back(round_from(round));
            });
}

std::vector<std::string> notes_of(const std::vector<Subject>& subjects, const Measured& measured,
                                  const EngineReport& engine, unsigned cores) {
    std::vector<std::string> notes;
    for (const Subject& subject : subjects)
        notes.insert(notes.end(), subject.notes.begin(), subject.notes.end());
    std::vector<double> units;
    for (const Round& round : measured.rounds)
        units.push_back(round.unit * 1e9);
    notes.push_back(fmt::format("Times are ratios, within a round, to reference<double> of \"{}\" on one thread, here "
                                "{:.3g} ns an evaluation; medians and "
                                "quartiles of {} rounds, each in an order of its own. Direct evaluation, god-object "
                                "and look-up are one thread, one "
                                "place after the other; a kernel's time is that of all voxels over their number, on {} "
                                "({} cores{}), without reading "
                                "back, of a mesh with the plan of where it is touched.",
                                measured.contenders[measured.unit].name, quartiles(units).median, units.size(),
                                engine.device, cores, engine.software ? ", a software device" : ""));
    notes.push_back("A closed loop's time is that of a step with its hand and its metrics; its errors are against the "
                    "same step of the same "
                    "path in double, when the probe may be elsewhere.");
    return notes;
}

} // namespace

StudyData study_error_time(StudyRun& run) {
    const bool quick = run.options().quick;
    const Extents extents = quick ? quick_extents() : default_extents();
    const std::vector<Subject> subjects = subjects_of(run, extents);
    Measured measured;
    for (const Subject& subject : subjects)
        add_contenders(measured.contenders, subject, extents, run.engine());
    const std::string unit = unit_name(subjects.front());
    while (measured.contenders[measured.unit].name != unit)
        ++measured.unit;
    Plan plan;
    plan_errors(plan, subjects, measured);
    if (!run.scene()) {
        plan_patches(plan, extents, measured);
        plan_lookups(plan, extents, measured);
    }
    plan_rounds(plan, extents, quick, measured);
    const std::vector<Json> results = run.run_steps(plan.steps);
    for (std::size_t i = 0; i < results.size(); ++i)
        plan.takers[i](results[i]);
    add_series(measured);
    StudyData data = run.data();
    data.notes = notes_of(subjects, measured, run.engine().report(), data.cores);
    data.tables = tables_of(measured);
    data.figures = figures_of(data.tables);
    data.findings = error_time_findings(data);
    return data;
}

} // namespace forceshade::study
