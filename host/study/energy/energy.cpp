// The study and its surfaces.
#include <algorithm>
#include <cmath>
#include <deque>

#include <fmt/format.h>

#include "host/error.h"
#include "host/paths/motions.h"
#include "host/study/energy/energy.h"
#include "host/touch/own_surfaces.h"
#include "host/touch/places.h"

namespace forceshade::study {
namespace {

struct Scheme {
    const char* name;
    Shading shading;
    DepthReading depth = DepthReading::vertical;
};

// Those of a scene's surface, those without shading first.
std::vector<Scheme> schemes_of(const Scene& scene) {
    switch (scene.surface.kind) {
    case SurfaceKind::bump: // with the scene's reading of depth alone
        return {{"unshaded", Shading::none, scene.force.depth}, {"shaded", Shading::reference, scene.force.depth}};
    case SurfaceKind::cylinder_bump:
        return {{"unshaded", Shading::none}};
    case SurfaceKind::height_map:
        return {{"unshaded", Shading::none}, {"shaded", Shading::height_map}};
    case SurfaceKind::mesh:
        break;
    }
    const bool barycentric = scene.force.shading == Shading::barycentric; // mean values, on triangles
    return {{"unshaded", Shading::none},
            {"morgenbesser", Shading::morgenbesser},
            barycentric ? Scheme{"barycentric", Shading::barycentric} : Scheme{"mean_value", Shading::mean_value},
            {"two_pass", Shading::two_pass}};
}

void add_laws(EnergySurface& surface, const PreparedCase& base, std::optional<double> elements,
              const std::vector<Scheme>& schemes, const std::vector<std::shared_ptr<const SceneMesh>>& drawn = {}) {
    for (const Scheme& scheme : schemes) {
        PreparedCase prepared = base;
        prepared.one.scene.force.shading = scheme.shading;
        prepared.one.scene.force.depth = scheme.depth;
        const auto shared = [&] { return std::make_shared<const PreparedCase>(prepared); };
        EnergyLaw& law = surface.laws.emplace_back(
            EnergyLaw{surface.name, scheme.name, elements, scheme.shading == Shading::none, shared()});
        for (const std::shared_ptr<const SceneMesh>& mesh : drawn) {
            prepared.images.mesh = mesh;
            law.drawn.push_back(shared());
        }
    }
}

// Strokes within the box of a studied surface, and over a bump alone.
EnergySurface surface_over(const char* name, const char* elements, const StudiedSurface& studied) {
    const auto& [low, high] = studied.box;
    const double across = std::min(high.x, kOwnHalfWidth);
    return {name, elements, {{-across, low.y}, {across, high.y}}};
}

EnergySurface own_bump(bool quick) {
    const StudiedSurface& studied = studied_surface("bump of 8 facets");
    EnergySurface surface = surface_over("bump", "facets", studied);
    const std::vector<Scheme> schemes{{"unshaded", Shading::none},
                                      {"unshaded, normal depth", Shading::none, DepthReading::normal},
                                      {"shaded", Shading::reference},
                                      {"shaded, normal depth", Shading::reference, DepthReading::normal}};
    for (const unsigned facets :
         quick ? std::vector<unsigned>{1, 2, 8, 32, 512} : std::vector<unsigned>{1, 2, 3, 4, 8, 16, 32, 128, 512}) {
        OwnSurface own = studied.own;
        own.facets = facets;
        add_laws(surface, own_case(own), facets, schemes);
    }
    return surface;
}

// Strokes take turns with tessellations drawn at random.
EnergySurface own_mesh(bool quick) {
    const StudiedSurface& studied = studied_surface("mesh");
    const double across = studied.box.high.x, along = studied.box.high.y;                       // m
    const double reach = std::hypot(kOwnRadius * std::asin(across / kOwnRadius), along) + 1e-3; // m
    EnergySurface surface = surface_over("mesh", "cells", studied);
    for (const unsigned cells : quick ? std::vector<unsigned>{8, 16} : std::vector<unsigned>{4, 8, 16, 32}) {
        OwnSurface own = studied.own;
        own.facets = own.rows = cells;
        const PreparedCase mesh = own_case(own);
        std::vector<std::shared_ptr<const SceneMesh>> drawn;
        for (std::uint64_t draw = 0; draw < (quick ? 8 : 25); ++draw)
            drawn.push_back(
                cylinder_patch({kOwnHalfWidth, kOwnRadius, cells, cells}, DrawnPatch{reach, 1000 * draw + cells}));
        add_laws(surface, mesh, cells, schemes_of(mesh.one.scene), drawn);
    }
    return surface;
}

struct Extents {
    std::size_t loops, loops_of_history; /* of a law */
    std::size_t steps;                   /* of a stroke; followed by the god-object */
    std::uint64_t columns;               /* of a section of curl */
};

Extents extents_of(bool quick) {
    return quick ? Extents{128, 16, 1024, 20} : Extents{250, 50, 2048, 60};
}

// The loops of a law on the strokes of its surface.
void add_loops_of(const EnergyLaw& law, const std::vector<Stroke>& strokes, const Extents& extents,
                  std::vector<LoopRow>& rows) {
    constexpr std::size_t kSteps = 256; // by the place alone: what matters is halved
    for (std::size_t i = 0; i < strokes.size(); ++i) {
        const EnergyLaw own = law.of_stroke(i);
        const auto places = places_of_loop(own, strokes[i], kSteps);
        const auto by_place = places ? work_by_place(own, *places) : std::nullopt;
        if (!by_place)
            continue;
        rows.push_back({&law, false, i, std::abs(by_place->work), by_place->effort});
        if (!law.prepared->images.mesh || i >= extents.loops_of_history)
            continue;
        auto fine = places_of_loop(own, strokes[i], extents.steps);
        const auto forth = work_by_history(own, *fine);
        std::ranges::reverse(*fine);
        const auto back = work_by_history(own, *fine);
        if (forth && back)
            rows.push_back({&law, true, i, std::max(forth->work, back->work), 0.5 * (forth->effort + back->effort)});
    }
}

// Of the study's own the bump with 8 facets; of a scene its own surface without and with its shading.
bool is_mapped(const EnergyLaw& law, const std::optional<PreparedCase>& scene) {
    const Shading shading = law.prepared->one.scene.force.shading;
    if (scene)
        return shading == Shading::none || shading == scene->one.scene.force.shading;
    return law.surface == "bump" && law.elements == 8 && (law.scheme == "unshaded" || law.scheme == "shaded");
}

} // namespace

EnergySurface scene_energy_surface(const PreparedCase& scene) {
    constexpr double kDeepestShare = 0.05; // of the region's longer side
    const PathsSpec given = scene.one.scene.paths.value_or(PathsSpec{});
    PathsSpec strokes;
    strokes.centre = given.centre;
    strokes.length = given.length;
    if (scene.images.mesh)
        strokes.drive = PathDrive::press; // not over the mesh's rim
    const PathRegion region = path_region(strokes, scene);
    if (!(region.length > 0))
        throw UsageError("paths.length leaves no room for a closed stroke: it must be above 0");
    const glm::dvec2 middle(region.centre[0], region.centre[1]), half = 0.5 * glm::dvec2(region.length, region.width);
    EnergySurface surface{"scene", "", {middle - half, middle + half}};
    surface.region.deepest = std::min(surface.region.deepest, kDeepestShare * std::max(region.length, region.width));
    add_laws(surface, scene, std::nullopt, schemes_of(scene.one.scene));
    return surface;
}

StudyData study_energy(StudyRun& run) {
    const Extents extents = extents_of(run.options().quick);
    EnergyResults results;
    if (run.scene())
        results.surfaces = {scene_energy_surface(*run.scene())};
    else
        results.surfaces = {own_bump(run.options().quick), own_mesh(run.options().quick)};
    std::vector<FileRecord> volumes;
    std::vector<Part> parts;
    std::deque<std::vector<LoopRow>> loops; // of each law
    for (EnergySurface& surface : results.surfaces) {
        surface.strokes = drawn_strokes(surface.region, extents.loops);
        for (const EnergyLaw& law : surface.laws) {
            const std::string of = fmt::format("{}{}, {}", surface.name,
                                               law.elements ? fmt::format(" of {}", *law.elements) : "", law.scheme);
            parts.push_back({"closed strokes on " + of,
                             [&, &rows = loops.emplace_back()] { add_loops_of(law, surface.strokes, extents, rows); },
                             true});
            if (is_mapped(law, run.scene()))
                parts.push_back({"curl of " + of, [&] {
                                     append(results.curl, curl_map(run.engine(), law, surface.region, extents.columns,
                                                                   run.options().folder, volumes));
                                 }});
        }
    }
    if (!run.rubbing().empty() || !run.options().renderers.empty())
        append(parts, renderer_parts(run, results.surfaces.front(), extents.loops_of_history, extents.steps,
                                     results.renderers));
    run.run(parts);
    for (const std::vector<LoopRow>& rows : loops)
        append(results.loops, rows);
    if (results.loops.empty())
        throw UsageError("no closed stroke over the scene's region stays in contact with its surface: set paths.centre "
                         "to the middle of it, or a shorter paths.length");
    results.laws = summarise_by_law(results.loops);
    StudyData data = run.data();
    data.volumes = volumes;
    add_energy(data, results);
    return data;
}

} // namespace forceshade::study
