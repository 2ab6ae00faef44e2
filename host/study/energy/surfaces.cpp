#include "host/study/energy/surfaces.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/error.h"
#include "host/paths/motions.h"
#include "host/study/energy/bump_mesh.h"

namespace forceshade::study {
namespace {

constexpr double kHalf = 0.0127, kRadius = 0.0254; // m: a, and R = 1000 mil
constexpr const char* kOwnBump = R"(
surface = {radius = "1000 mil", width = "1000 mil"}
force.stiffness = "1000 N/m"
)";

struct Scheme {
    const char* name;
    Shading shading;
    DepthReading depth = DepthReading::vertical;
};

// Those without shading first.
std::vector<Scheme> schemes_of(const PreparedCase& scene) {
    switch (scene.one.scene.surface.kind) {
    case SurfaceKind::bump:
        return {{"unshaded", Shading::none},
                {"unshaded, normal depth", Shading::none, DepthReading::normal},
                {"shaded", Shading::reference},
                {"shaded, normal depth", Shading::reference, DepthReading::normal}};
    case SurfaceKind::cylinder_bump:
        return {{"unshaded", Shading::none}};
    case SurfaceKind::height_map:
        return {{"unshaded", Shading::none}, {"shaded", Shading::height_map}};
    case SurfaceKind::mesh:
        break;
    }
    const bool barycentric = scene.one.scene.force.shading == Shading::barycentric; // mean values, on triangles
    return {{"unshaded", Shading::none},
            {"morgenbesser", Shading::morgenbesser},
            barycentric ? Scheme{"barycentric", Shading::barycentric} : Scheme{"mean_value", Shading::mean_value},
            {"two_pass", Shading::two_pass}};
}

void add_laws(EnergySurface& surface, const PreparedCase& base, std::optional<double> elements) {
    for (const Scheme& scheme : schemes_of(base)) {
        auto prepared = std::make_shared<PreparedCase>(base);
        prepared->one.scene.force.shading = scheme.shading;
        prepared->one.scene.force.depth = scheme.depth;
        surface.laws.push_back({surface.name, scheme.name, elements, scheme.shading == Shading::none, prepared});
    }
}

EnergySurface own_bump(const PreparedCase& own, bool quick) {
    EnergySurface surface{"bump", "facets", {{-kHalf, -0.005}, {kHalf, 0.005}}};
    for (const unsigned facets :
         quick ? std::vector<unsigned>{1, 2, 8, 32, 512} : std::vector<unsigned>{1, 2, 3, 4, 8, 16, 32, 128, 512}) {
        PreparedCase base = own;
        base.one.scene.surface.facets = facets;
        add_laws(surface, base, facets);
    }
    return surface;
}

EnergySurface own_mesh(const PreparedCase& own, bool quick) {
    EnergySurface surface{"mesh", "cells", {{-kHalf, -0.8 * kHalf}, {kHalf, 0.8 * kHalf}}};
    for (const unsigned cells : quick ? std::vector<unsigned>{4, 16} : std::vector<unsigned>{4, 8, 16, 32}) {
        PreparedCase base = own;
        base.one.scene.surface.kind = SurfaceKind::mesh;
        base.images.mesh = bump_mesh({kHalf, kRadius, cells, cells, MeshCells::triangles});
        add_laws(surface, base, cells);
    }
    return surface;
}

} // namespace

std::vector<EnergySurface> own_energy_surfaces(bool quick) {
    const PreparedCase own = CasePreparation().prepare(parse_scene(kOwnBump, "the study's own scene"));
    return {own_bump(own, quick), own_mesh(own, quick)};
}

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
        throw UsageError("paths.length leaves no room for a loop: it must be above 0");
    const glm::dvec2 middle(region.centre[0], region.centre[1]), half = 0.5 * glm::dvec2(region.length, region.width);
    EnergySurface surface{"scene", "", {middle - half, middle + half}};
    surface.region.deepest = std::min(surface.region.deepest, kDeepestShare * std::max(region.length, region.width));

    add_laws(surface, scene, std::nullopt);
    if (scene.one.scene.surface.kind == SurfaceKind::bump) { // the scene's reading of depth alone
        const DepthReading depth = scene.one.scene.force.depth;
        std::erase_if(surface.laws, [&](const EnergyLaw& law) { return law.prepared->one.scene.force.depth != depth; });
        for (EnergyLaw& law : surface.laws)
            law.scheme = law.unshaded ? "unshaded" : "shaded";
    }
    return surface;
}

} // namespace forceshade::study
