#include "host/study/energy/energy.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/study/energy/results.h"

namespace forceshade::study {
namespace {

struct Extents {
    std::size_t loops, loops_of_history; /* of a law */
    std::size_t steps;                   /* of a stroke; followed by the god-object */
    std::uint64_t columns;               /* of a map of curl */
};

Extents extents_of(bool quick) {
    return quick ? Extents{128, 16, 1024, 20} : Extents{250, 50, 2048, 60};
}

// The loops of a law on the strokes of its surface.
void add_loops_of(const EnergyLaw& law, const std::vector<Stroke>& strokes, const Extents& extents,
                  std::vector<LoopRow>& rows) {
    constexpr std::size_t kSteps = 256; // by the place alone: what matters is halved
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        const auto places = places_of_loop(law, strokes[i], kSteps);
        const auto by_place = places ? work_by_place(law, *places) : std::nullopt;
        if (!by_place)
            continue;
        rows.push_back({&law, false, i, std::abs(by_place->work), by_place->effort});
        if (!law.prepared->images.mesh || i >= extents.loops_of_history)
            continue;
        auto fine = places_of_loop(law, strokes[i], extents.steps);
        const auto forth = work_by_history(law, *fine);
        std::ranges::reverse(*fine);
        const auto back = work_by_history(law, *fine);
        if (forth && back)
            rows.push_back({&law, true, i, std::max(forth->work, back->work), 0.5 * (forth->effort + back->effort)});
    }
}

// Of the study's own those of the bump with 8 facets; of a scene its own surface without shading and with that it has.
bool is_mapped(const EnergyLaw& law, const std::optional<PreparedCase>& scene) {
    const Shading shading = law.prepared->one.scene.force.shading;
    if (scene)
        return shading == Shading::none || shading == scene->one.scene.force.shading;
    return law.surface == "bump" && law.elements == 8 && (law.scheme == "unshaded" || law.scheme == "shaded");
}

} // namespace

StudyData study_energy(StudyRun& run) {
    const Extents extents = extents_of(run.options().quick);
    EnergyResults results;
    results.surfaces =
        run.scene() ? std::vector{scene_energy_surface(*run.scene())} : own_energy_surfaces(run.options().quick);
    std::vector<FileRecord> volumes;
    std::vector<Part> parts;
    for (EnergySurface& surface : results.surfaces) {
        surface.strokes = drawn_strokes(surface.region, extents.loops);
        for (const EnergyLaw& law : surface.laws) {
            const std::string of = law.elements ? fmt::format(" of {}", *law.elements) : "";
            parts.push_back({fmt::format("loops on {}{}, {}", surface.name, of, law.scheme),
                             [&] { add_loops_of(law, surface.strokes, extents, results.loops); }});
            if (is_mapped(law, run.scene()))
                parts.push_back({fmt::format("curl of {}{}, {}", surface.name, of, law.scheme), [&] {
                                     std::ranges::move(curl_map(run.engine(), law, surface.region, extents.columns,
                                                                run.options().folder, volumes),
                                                       std::back_inserter(results.curl));
                                 }});
        }
    }
    run.run(parts);
    if (results.loops.empty())
        throw UsageError(
            "no loop drawn over the scene's region stays in contact with its surface: name a place over the "
            "middle of it with paths.centre, or a shorter way with paths.length");
    results.laws = summed_up(results.loops);
    StudyData data = run.data();
    data.volumes = volumes;
    add_energy(data, results);
    return data;
}

} // namespace forceshade::study
