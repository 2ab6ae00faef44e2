#include "host/study/stability/stability.h"

#include <optional>

#include <fmt/format.h>

#include "host/study/stability/number.h"
#include "host/study/stability/tables.h"
#include "host/study/stability/worst_rounding.h"

namespace forceshade::study {
namespace {

// Where the hand is its own, the worst place of each kind stepped through the surface's own force.
void simulate_worst(const LoopSurface& surface, std::vector<LeastLimit>& limits) {
    for (const PlaceKind kind : kPlaceKinds) {
        LeastLimit* worst = nullptr;
        for (LeastLimit& one : limits)
            if (one.own && one.place.kind == kind && one.limit && (!worst || *one.limit < *worst->limit))
                worst = &one;
        if (worst) {
            worst->simulated = simulated_limit(surface, *worst);
            worst->kick = largest_kick(surface, *worst);
        }
    }
}

void study_surface(Engine& engine, const LoopSurface& surface, bool quick, LoopResults& results) {
    const std::size_t points = quick ? (surface.is_mesh() ? 40 : 60) : (surface.is_mesh() ? 200 : 400);
    const std::vector<RestPlace> places = rest_places(surface, points);
    std::vector<LeastLimit> limits = least_limits(surface, places, quick);
    simulate_worst(surface, limits);
    std::ranges::move(limits, std::back_inserter(results.limits));
    std::ranges::move(edge_swings(engine, surface, places), std::back_inserter(results.swings));
    for (const auto& [x, z] : felt_profile(surface))
        results.profile.push_back({surface.name, x, z});
}

// Of the surface that bears least, where no edge is near: paths of a map go further than a limit's disturbance.
void add_maps(Engine& engine, bool quick, LoopResults& results) {
    const LeastLimit *worst = results.worst(), *flat = results.worst(results.surfaces.front().name);
    if (!worst || !flat)
        return;
    for (const LeastLimit& one : results.limits)
        if (one.own && one.limit && one.surface == worst->surface && one.place.kind == PlaceKind::crest &&
            (worst->place.kind != PlaceKind::crest || *one.limit < *worst->limit))
            worst = &one;
    const auto surface = std::ranges::find(results.surfaces, worst->surface, &LoopSurface::name);
    LeastLimit held = *worst; // paths press down or are held on all sides
    held.hold = worst->place.force.z > 0 ? Hold{"down", {0, 0, 1}} : Hold{"on all sides", glm::dvec3(0)};
    held.limit = linear_limit(held.cell.hand, held.cell.rate, held.hold, held.place.slope);
    results.map_kind = name_of(held.place.kind);
    results.maps = damping_map(engine, *surface, held, quick);
    std::ranges::move(rounding_map(engine, results.surfaces.front(), flat->place, quick),
                      std::back_inserter(results.maps));
    results.curves = curves_over(results.maps, held);
}

} // namespace

StudyData study_stability(StudyRun& run) {
    const bool quick = run.options().quick;
    LoopResults loops;
    loops.surfaces = run.scene() ? std::vector{scene_surface(*run.scene())} : own_surfaces();
    std::vector<Part> parts;
    for (const LoopSurface& surface : loops.surfaces)
        parts.push_back({"loops on " + surface.name, [&] { study_surface(run.engine(), surface, quick, loops); }});
    parts.push_back({"maps of loops", [&] { add_maps(run.engine(), quick, loops); }});
    std::vector<WorstRounding> worst;
    std::vector<NumberRow> numbers;
    if (!run.scene()) { // precision is that of plain surfaces of the study's own
        std::ranges::move(number_parts(run.engine(), quick, numbers), std::back_inserter(parts));
        std::ranges::move(worst_rounding_parts(quick, worst), std::back_inserter(parts));
    }
    run.run(parts);
    StudyData data = run.data();
    add_loops(data, loops);
    data.findings = loop_findings(loops);
    if (!run.scene()) {
        add_numbers(data, numbers);
        add_worst_rounding(data, worst);
    }
    return data;
}

} // namespace forceshade::study
