// The study and its surfaces.
#include "host/study/stability/stability.h"

#include <algorithm>
#include <deque>
#include <tuple>

#include "host/limits/limits.h"
#include "host/touch/own_surfaces.h"
#include "host/touch/places.h"

namespace forceshade::study {
namespace {

// Of each kind of place of a mesh: the least limit next to an edge, and the least at or next to a vertex; stepped, too.
std::vector<LeastLimit> limits_by_edges(const LoopSurface& surface, const std::vector<RestPlace>& places,
                                        const LoopCell& cell) {
    std::vector<LeastLimit> all;
    for (const PlaceKind kind : kPlaceKinds)
        for (const bool vertex : {false, true}) {
            std::vector<const RestPlace*> some;
            for (const RestPlace& place : places)
                if (place.kind == kind && !jumps(kind) && place.by_vertex == vertex && (vertex || place.edge_distance))
                    some.push_back(&place);
            if (some.empty())
                continue;
            LeastLimit& one = all.emplace_back(least_of(surface, some, cell));
            one.simulated = simulated_limit(surface, one);
        }
    return all;
}

// The own hand's limits on the mesh and on others of the same cells, turned and moved at random.
std::vector<TessellatedLimit> limits_by_tessellation(const LoopSurface& surface, const std::vector<LeastLimit>& limits,
                                                     std::size_t points, bool quick) {
    std::vector<TessellatedLimit> all;
    const auto add = [&](std::size_t tessellation, const std::vector<LeastLimit>& some) {
        for (const LeastLimit& one : some)
            if (one.own)
                all.push_back({tessellation, one});
    };
    add(0, limits);
    const SurfaceSpec& spec = surface.prepared.one.scene.surface;
    const double beyond = surface.deepest; // m: of the surface above a probe
    const double reach =
        std::hypot(spec.radius * std::asin((surface.high.x + beyond) / spec.radius), surface.high.y + beyond);
    for (std::size_t number = 1; number <= (quick ? 2 : 4); ++number) {
        LoopSurface other = surface;
        other.prepared.images.mesh =
            cylinder_patch({spec.width / 2, spec.radius, kMeshCells, kMeshCells}, DrawnPatch{reach, number});
        std::vector<LeastLimit> found = least_limits(other, searched_places(other, points, Searched::of_each_kind),
                                                     {settings_of(surface, true).front()}, true);
        for (LeastLimit& one : found)
            if (&one == worst_of(found, surface.name))
                one.simulated = simulated_limit(other, one);
        add(number, found);
    }
    return all;
}

// Every 4 deg from straight down towards the least of any press and on, until the loop grows at any stiffness or the
// press leads away from the surface.
std::vector<PressLimit> limits_by_press(const LoopSurface& surface, const std::vector<LeastLimit>& limits) {
    const LeastLimit* weakest = nullptr;
    for (const LeastLimit& one : limits)
        if (one.own && one.any_press && (!weakest || one.any_press->limit < weakest->any_press->limit))
            weakest = &one;
    if (!weakest)
        return {};
    const LoopCell& cell = weakest->cell;
    const HoldLimit* const least = &*weakest->any_press;
    const glm::dvec3 aside(least->hold.along.x, least->hold.along.y, 0);
    const glm::dvec3 side = glm::length(aside) > 0 ? glm::normalize(aside) : glm::dvec3(1, 0, 0);
    std::vector<PressLimit> rows;
    for (double turn = 0; turn <= 180; turn += 4) {
        const glm::dvec3 along = std::cos(turn * kDegree) * glm::dvec3(0, 0, 1) + std::sin(turn * kDegree) * side;
        const bool counts = supports(along, least->place.force, least->place.slope);
        const auto limit =
            linear_limit(cell.hand, cell.rate, pressed_along(along), least->place.force_around(), cell.lag);
        if (limit)
            rows.push_back({surface.name, turn, *limit, counts, least->place});
        if (!counts && (!(limit.value_or(1) > 0) || !(glm::dot(along, least->place.force) > 0)))
            break;
    }
    return rows;
}

// With the surface's own hand, the worst place of each kind is also stepped through the surface's own force.
void study_surface(Engine& engine, const LoopSurface& surface, bool quick, LoopResults& results) {
    const std::size_t points = quick ? (surface.is_mesh() ? 40 : 60) : (surface.is_mesh() ? 200 : 400);
    const std::vector<RestPlace> places = searched_places(surface, points, Searched::of_each_kind);
    std::vector<LoopCell> settings = settings_of(surface, quick);
    if (surface.limits_alone)
        settings.resize(1); // the surface's own hand
    append(results.limits, least_limits(surface, places, settings, true));
    for (LeastLimit& one : results.limits)
        if (&one == worst_of(results.limits, surface.name, {}, one.place.kind)) {
            one.simulated = simulated_limit(surface, one);
            one.kick = largest_kick(surface, one);
            if (one.any_press) {
                LeastLimit turned = one;
                std::tie(turned.limit, turned.hold, turned.place) =
                    std::tuple(one.any_press->limit, one.any_press->hold, one.any_press->place);
                one.any_press->simulated = simulated_limit(surface, turned);
            }
        }
    append(results.presses, limits_by_press(surface, results.limits));
    std::vector<LeastLimit> by_grip = results.limits; // with other grips, too
    std::erase_if(by_grip, [&](const LeastLimit& one) {
        return one.cell.rate != surface.rate || damping_of(one.cell.hand) != damping_of(surface.hand) ||
               one.cell.hand.delay_samples != surface.hand.delay_samples;
    });
    append(results.weak, weak_places("the " + surface.name, by_grip));
    if (surface.is_mesh())
        append(results.by_edges, limits_by_edges(surface, places, settings.front()));
    if (surface.is_mesh() && surface.stiffness == 0) // not the user's
        append(results.tessellated, limits_by_tessellation(surface, results.limits, points, quick));
    if (surface.limits_alone)
        return;
    const bool first = surface.stiffness > 0 || surface.name == "plane"; // a scene, or the plane
    append(results.atlas, atlas_of(surface, results.limits, quick, first ? &engine : nullptr));
    append(results.basins, basins_of(surface, results.limits, quick));
    append(results.swings, edge_swings(engine, surface, places));
    append(results.couplings, couplings_on(surface, places));
    for (const auto& [x, z] : direction_profile(surface))
        results.profile.push_back({surface.name, x, z});
}

// At the surface with the lowest limit, away from edges: paths of a diagram go further than a limit's disturbance.
void add_maps(Engine& engine, bool quick, LoopResults& results) {
    const LoopSurface& first = results.surfaces.front();
    const LeastLimit *worst = worst_of(results.limits), *flat = worst_of(results.limits, first.name);
    if (!worst || !flat)
        return;
    const LeastLimit* crest = worst_of(results.limits, worst->surface, {}, PlaceKind::crest);
    LeastLimit held = crest ? *crest : *worst; // paths press down or are held on all sides
    const auto surface = std::ranges::find(results.surfaces, held.surface, &LoopSurface::name);
    held.hold = held.place.force.z > 0 ? Hold{"down", {0, 0, 1}} : Hold{"on all sides", glm::dvec3(0)};
    held.limit = linear_limit(held.cell.hand, held.cell.rate, held.hold, held.place.force_around());
    results.diagram_kind = name_of(held.place.kind);
    results.diagrams = damping_diagram(engine, *surface, held, quick);
    append(results.diagrams, rounding_diagram(engine, first, flat->place, quick));
    if (!first.is_mesh())
        append(results.diagrams, coupling_diagram(engine, first, flat->place, quick));
    if (const LeastLimit* deep = worst_of(results.limits, first.name, first.deepest, PlaceKind::flat);
        deep && !first.is_mesh())
        append(results.diagrams, basin_diagram(engine, first, deep->place, quick));
    results.curves = curves_over(results.diagrams, held);
}

template <typename T> std::vector<T> joined(std::deque<std::vector<T>>& parts) {
    std::vector<T> all;
    for (std::vector<T>& part : parts)
        append(all, std::move(part));
    return all;
}

} // namespace

std::vector<LoopSurface> own_surfaces() {
    std::vector<LoopSurface> surfaces;
    for (auto [name, own, box, examined, volume] : studied_surfaces(kLimits)) {
        LoopSurface& surface = surfaces.emplace_back();
        surface.name = name;
        own.stiffness = 1;
        surface.prepared = own_case(own);
        surface.low = box.low;
        surface.high = box.high;
        surface.limits_alone = !(examined & kLoops);
    }
    return surfaces;
}

std::vector<CouplingRow> couplings_on(const LoopSurface& surface, const std::vector<RestPlace>& places) {
    std::vector<CouplingRow> rows;
    std::vector<double> scenes{1e4, 1e5, 1e6, 1e7}; /* N/m */
    if (surface.stiffness > 0 && std::ranges::count(scenes, surface.stiffness) == 0)
        scenes.insert(scenes.begin(), surface.stiffness);
    const auto add = [&](const char* which, double scene, const HoldingCoupling& coupling, const HandSpec& hand) {
        CouplingRow row{surface.name, which, scene, coupling, hand.coupling_filter.value_or(0), true, {}};
        if (coupling.weakest) {
            LeastLimit softer = *coupling.weakest, stiffer = softer;
            softer.cell.hand.coupling_stiffness *= 0.98;
            stiffer.cell.hand.coupling_stiffness *= 1.02;
            row.foreseen = decays(surface, softer) && !decays(surface, stiffer);
        }
        rows.push_back(row);
    };
    if (const HandSpec& own = surface.prepared.one.scene.hand; own.coupled()) {
        add("own", surface.stiffness, {own.coupling_stiffness, own.coupling_damping, {}}, own);
        rows.back().rests = RestTrials(surface.rate, surface.stiffness, places).all_rest(own);
    }
    const double passive = passive_stiffness(damping_of(surface.hand), 1 / surface.rate, surface.hand.delay_samples);
    for (const double scene : scenes) {
        const bool needed = scene > passive || !RestTrials(surface.rate, scene, places).all_rest(surface.hand);
        if (const auto safe = safe_coupling(surface.hand, surface.rate, scene, places); safe && needed)
            add("safe", scene, *safe, surface.hand);
        if (const auto stiffest = stiffest_coupling(surface.hand, surface.rate, scene, places))
            add("stiffest", scene, *stiffest, surface.hand);
    }
    HandSpec filtered = surface.hand;
    filtered.coupling_filter = kUsualFilter / surface.rate;
    if (const auto stiffest = stiffest_coupling(filtered, surface.rate, scenes.back(), places))
        add("filtered", scenes.back(), *stiffest, filtered);
    return rows;
}

StudyData study_stability(StudyRun& run) {
    const bool quick = run.options().quick;
    LoopResults loops;
    loops.surfaces = run.scene() ? std::vector{scene_surface(*run.scene())} : own_surfaces();
    std::deque<LoopResults> by_surface;
    std::deque<std::vector<LawRounding>> by_law;
    std::deque<std::vector<NumberRow>> by_number;
    std::vector<Part> parts;
    for (const LoopSurface& surface : loops.surfaces)
        parts.push_back({"loops on " + surface.name,
                         [&, &own = by_surface.emplace_back()] { study_surface(run.engine(), surface, quick, own); },
                         true});
    append(parts, worst_rounding_parts(run.scene() ? &*run.scene() : nullptr, quick, by_law));
    std::ranges::reverse(parts); // the longest first: thin meshes, dips
    if (!run.scene())            // of plain surfaces of the study's own
        append(parts, number_parts(run.engine(), quick, by_number));
    parts.push_back({"diagrams of loops", [&] {
                         for (LoopResults& own : by_surface) {
                             append(loops.limits, std::move(own.limits));
                             append(loops.by_edges, std::move(own.by_edges));
                             append(loops.tessellated, std::move(own.tessellated));
                             append(loops.atlas, std::move(own.atlas));
                             append(loops.basins, std::move(own.basins));
                             append(loops.swings, std::move(own.swings));
                             append(loops.couplings, std::move(own.couplings));
                             append(loops.profile, std::move(own.profile));
                             append(loops.presses, std::move(own.presses));
                             append(loops.weak, std::move(own.weak));
                         }
                         add_maps(run.engine(), quick, loops);
                     }});
    run.run(parts);
    const std::vector<RendererLimit> by_renderer = renderer_limits(run, loops.surfaces.front(), loops.limits);
    StudyData data = run.data();
    add_loops(data, loops);
    data.findings = loop_findings(loops);
    if (!run.scene()) {
        data.weak_places = weak_places_text(loops.weak);
        add_numbers(data, joined(by_number));
    }
    add_worst_rounding(data, joined(by_law), !run.scene());
    add_renderer_limits(data, loops.surfaces.front(), run.rubbing(), by_renderer);
    return data;
}

} // namespace forceshade::study
