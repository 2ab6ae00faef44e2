#include "host/study/error_time/error_time.h"

#include <fmt/format.h>

#include "host/study/error_time/measured.h"

namespace forceshade::study {
namespace {

using namespace error_time;

std::vector<std::string> notes_of(const std::vector<Subject>& subjects, const Way& unit, const EngineReport& engine,
                                  unsigned cores) {
    std::vector<std::string> notes;
    for (const Subject& subject : subjects) {
        notes.insert(notes.end(), subject.notes.begin(), subject.notes.end());
        notes.push_back(fmt::format(
            "Of \"{}\", places lie under points anywhere on the surface, {:.3g} to {:.3g} mm deep along its normal, "
            "log-uniform. Kinds: rim, if the smooth shape turns by more than 5 deg within {:.3g} mm; else edge, if the "
            "facets turn by more than 0.5 deg; else boundary, if the depth is below {:.3g} mm, and as many places as "
            "far above the surface; else flat or, where anything turns, facet.",
            subject.name, 1e3 * subject.scale.shallowest(), 1e3 * subject.scale.deepest, 1e3 * subject.scale.ring(),
            1e3 * subject.scale.skin()));
    }
    notes.push_back(fmt::format(
        "Times are of paired rounds, each in an order of its own; intervals are 95 % of 1000 bootstrap samples of the "
        "median ratio to \"{}\" in the same round. Direct evaluation, god-object and look-up are one thread, one place "
        "after the other; a field's time is that of all voxels over their number, on {} ({} cores{}), without reading "
        "back, of a mesh with the plan of where it is touched.",
        unit.name, engine.device, cores, engine.software ? ", a software device" : ""));
    return notes;
}

} // namespace

StudyData study_error_time(StudyRun& run) {
    const Extents extents = extents_of(run.options().quick);
    const std::vector<Subject> subjects =
        run.scene() ? std::vector{scene_subject(*run.scene(), extents)} : own_subjects(extents);
    EngineOptions one_thread;
    one_thread.cpu = true;
    one_thread.threads = 1;
    const std::unique_ptr<Engine> alone = make_engine(one_thread);
    std::vector<Way> ways;
    for (const Subject& subject : subjects)
        add_ways(ways, subject, run.engine(), *alone);
    std::vector<std::optional<WayErrors>> errors(ways.size());
    std::vector<Round> rounds;
    std::vector<Part> parts;
    for (const Subject& subject : subjects)
        for (const Variant& variant : subject.variants)
            parts.push_back({fmt::format("errors of {}, {}", subject.name, variant.name),
                             [&] { add_errors(errors, ways, subject, variant, extents); }});
    parts.push_back({"compiling", [&] { measure_round(ways, 0); }}); // and making volumes: not within a round
    for (std::size_t round = 1; round <= extents.rounds; ++round)
        parts.push_back({"times", [&, round] { rounds.push_back(measure_round(ways, round)); }});
    run.run(parts);
    // The unit of time: the first subject's thorough law, shaded, in double.
    std::size_t unit = 0;
    for (std::size_t i = 0; i < ways.size(); ++i)
        if (ways[i].subject == &subjects.front() && ways[i].variant->thorough && ways[i].family == "direct" &&
            ways[i].precision == "f64")
            unit = i;
    const Times times(std::move(rounds), unit);
    const Measured measured{subjects, ways, errors, times};
    StudyData data = run.data();
    data.notes = notes_of(subjects, ways[unit], run.engine().report(), data.cores);
    data.tables = tables_of(measured);
    data.figures = figures_of(measured, !run.scene());
    data.findings = error_time::findings_of(measured);
    return data;
}

} // namespace forceshade::study
