// The surface of a scene, as loops rest on it.
#include <fmt/format.h>

#include "host/error.h"
#include "host/limits/rest_places.h"
#include "host/touch/places.h"

namespace forceshade {
namespace {

void refuse_dead_hand(const Scene& scene) {
    if (!(scene.force.stiffness > 0))
        throw UsageError("force.stiffness is 0: a loop needs a force; use a stiffness above 0");
    if (!(scene.hand.damping + scene.hand.grip_damping > 0))
        throw UsageError("hand.damping and hand.grip_damping are 0: without damping no sampled loop comes to rest at "
                         "any stiffness");
}

} // namespace

LoopSurface scene_surface(const PreparedCase& given) {
    const Scene& scene = given.one.scene;
    refuse_dead_hand(scene);
    LoopSurface surface;
    surface.name = "scene";
    surface.prepared = given;
    surface.prepared.one.scene.force.stiffness = 1;
    if (surface.prepared.one.scene.texture)
        surface.prepared.one.scene.texture->stiffness /= scene.force.stiffness;
    surface.hand = coupled(scene.hand, 0, 0);
    surface.rate = scene.paths.value_or(PathsSpec{}).rate;
    surface.stiffness = scene.force.stiffness;
    const TouchedShape shape = scene_shape(given);
    surface.low = shape.low;
    surface.high = shape.high;
    surface.deepest = shape.scale.deepest;
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
