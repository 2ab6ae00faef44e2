// The surface of a scene, as loops rest on it.
#include <algorithm>

#include <fmt/format.h>

#include "host/error.h"
#include "host/limits/rest_places.h"
#include "host/paths/motions.h"

namespace forceshade {
namespace {

void refuse_dead_hand(const Scene& scene) {
    if (!(scene.force.stiffness > 0))
        throw UsageError("force.stiffness is 0: a loop needs a force; use a stiffness above 0");
    if (!(scene.hand.damping + scene.hand.grip_damping > 0))
        throw UsageError("hand.damping and hand.grip_damping are 0: without damping no sampled loop comes to rest at "
                         "any stiffness");
}

// The box of a scene's grid; of a scene of paths alone that of its mesh, or of its paths.
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

std::string hand_text(const LoopSurface& surface, bool with_delay) {
    const HandSpec& hand = surface.hand;
    return fmt::format("hand of {:.3g} kg, {:.3g} N s/m, grip {:.4g} N/m, {:.4g} Hz{}", hand.mass,
                       hand.damping + hand.grip_damping, hand.grip_stiffness, surface.rate,
                       !with_delay              ? ""
                       : hand.delay_samples > 0 ? fmt::format(", {} samples late", hand.delay_samples)
                                                : ", no delay");
}

} // namespace forceshade
