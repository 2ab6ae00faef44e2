#include "host/study/stability/surfaces.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/paths/motions.h"
#include "host/scene/study.h"
#include "host/study/energy/bump_mesh.h"

namespace forceshade::study {
namespace {

struct OwnScene {
    const char *name, *text;
    glm::dvec3 low, high; /* m */
};

// The box of a bump or map goes 2.5 mm beyond it on either side.
const OwnScene kOwnScenes[] = {
    {"plane", "surface = {facets = 1}", {-0.005, -0.005, -0.003}, {0.005, 0.005, 0.002}},
    {"bump", "surface = {facets = 2}", {-0.0152, -0.005, -0.003}, {0.0152, 0.005, 0.008}},
    {"shaded bump",
     "surface = {facets = 2}\nforce.shading = \"reference\"",
     {-0.0152, -0.005, -0.003},
     {0.0152, 0.005, 0.008}},
    {"map of a bump",
     "surface = {kind = \"height_map\", function = \"cylinder\", radius = \"1000 mil\"}\n"
     "force.shading = \"height_map\"",
     {-0.0152, -0.005, -0.003},
     {0.0152, 0.005, 0.002}},
    {"map of a dip",
     "surface = {kind = \"height_map\", function = \"dip\", radius = \"1000 mil\"}\nforce.shading = \"height_map\"",
     {-0.0152, -0.005, -0.003},
     {0.0152, 0.005, 0.002}},
};
constexpr glm::dvec3 kMeshLow{-0.0105, -0.008, -0.003}, kMeshHigh{0.0105, 0.008, 0.008}; // m: away from its borders

LoopSurface own_surface(std::string name, const Scene& scene, const glm::dvec3& low, const glm::dvec3& high) {
    LoopSurface surface;
    surface.name = std::move(name);
    surface.prepared.one.scene = scene;
    surface.prepared.one.scene.force.stiffness = 1;
    surface.low = low;
    surface.high = high;
    return surface;
}

LoopSurface own_mesh(const char* name, Shading shading, const std::shared_ptr<const SceneMesh>& mesh) {
    Scene scene;
    scene.surface.kind = SurfaceKind::mesh;
    scene.surface.mesh.file = "bump";
    scene.force.shading = shading;
    LoopSurface surface = own_surface(name, scene, kMeshLow, kMeshHigh);
    surface.prepared.images.mesh = mesh;
    return surface;
}

void refuse_dead_hand(const Scene& scene) {
    if (!(scene.force.stiffness > 0))
        throw UsageError("force.stiffness is 0: no loop closes without a force");
    if (!(scene.hand.damping + scene.hand.grip_damping > 0))
        throw UsageError("hand.damping and hand.grip_damping are 0: without damping no sampled loop comes to rest at "
                         "any stiffness");
}

// The box of a scene's grid; of a scene of paths alone that of its mesh, or what its paths go over.
void take_box(LoopSurface& surface, const PathsSpec& paths) {
    const Scene& scene = surface.prepared.one.scene;
    if (!scene.field && !surface.is_mesh()) {
        const PathRegion region = path_region(paths, surface.prepared);
        const double length = region.length / 2, width = region.width / 2, reach = std::max(length, width);
        surface.low = {region.centre[0] - length, region.centre[1] - width, region.height - reach};
        surface.high = {region.centre[0] + length, region.centre[1] + width, region.height + reach};
        return;
    }
    constexpr std::uint64_t kSide = 64; // voxels
    const GridSpec grid = scene.field ? scene.grid : fitted_grid(kSide, surface.prepared.images.mesh->mesh);
    for (int i = 0; i < 3; ++i) {
        const auto axis = static_cast<std::size_t>(i);
        surface.low[i] = grid.origin[axis];
        surface.high[i] = grid.origin[axis] + grid.spacing[axis] * static_cast<double>(grid.size[axis] - 1);
    }
}

} // namespace

std::vector<LoopSurface> own_surfaces() {
    std::vector<LoopSurface> surfaces;
    for (const OwnScene& own : kOwnScenes)
        surfaces.push_back(
            own_surface(own.name, parse_scene(own.text, "the study's own scene").scene, own.low, own.high));
    const auto mesh = bump_mesh({0.0127, 0.0254, 8, 8, MeshCells::triangles});
    surfaces.push_back(own_mesh("mesh", Shading::none, mesh));
    surfaces.push_back(own_mesh("shaded mesh", Shading::mean_value, mesh));
    return surfaces;
}

LoopSurface scene_surface(const PreparedCase& given) {
    constexpr double kDeepestShare = 0.05; // of the box's longest side
    const Scene& scene = given.one.scene;
    refuse_dead_hand(scene);
    PathsSpec paths = scene.paths.value_or(PathsSpec{});
    if (paths.kind == PathKind::recorded)
        paths.kind = PathKind::strokes;
    LoopSurface surface;
    surface.name = "scene";
    surface.prepared = given;
    surface.prepared.one.scene.force.stiffness = 1;
    if (surface.prepared.one.scene.texture)
        surface.prepared.one.scene.texture->stiffness /= scene.force.stiffness;
    surface.hand = scene.hand;
    surface.rate = paths.rate;
    surface.stiffness = scene.force.stiffness;
    take_box(surface, paths);
    const glm::dvec3 size = surface.high - surface.low;
    surface.deepest = std::min(surface.deepest, kDeepestShare * std::max({size.x, size.y, size.z}));
    return surface;
}

} // namespace forceshade::study
