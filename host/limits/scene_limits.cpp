// Whether a scene is stable with its hand.
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/limits/coupling_limits.h"

namespace forceshade {

SceneLimits scene_limits(const PreparedCase& prepared, double rate, double most, double scale) {
    constexpr std::size_t kPoints = 60, kPointsOfMesh = 40;
    const Scene& scene = prepared.one.scene;
    SceneLimits found;
    found.stiffness = scale * scene.force.stiffness;
    if (!(damping_of(scene.hand) > 0 && found.stiffness > 0))
        return found;
    const HandSpec bare = coupled(scene.hand, 0, 0);
    found.wall = wall_limit(bare, rate);
    if (scene.hand.coupled())
        found.coupling = scene.hand.coupling_stiffness;
    LoopSurface surface;
    surface.hand = scene.hand;
    surface.rate = rate;
    found.hand = hand_text(surface);
    try {
        surface = scene_surface(prepared);
        surface.rate = rate;
        surface.deepest = std::min(surface.deepest, most / scene.force.stiffness);
        const auto places = rest_places(surface, surface.is_mesh() ? kPointsOfMesh : kPoints);
        for (const LeastLimit& one : least_limits(surface, places, {{bare, rate, 1}}))
            if (one.limit && (!found.least || *one.limit < *found.least->limit))
                found.least = one;
        found.coupled_rests = RestTrials(rate, found.stiffness, places).all_rest(scene.hand);
        if (!found.stable())
            if (const auto couplings = coupling_limits(bare, rate, found.stiffness, places))
                if (couplings->safe)
                    found.safe = couplings->safe->stiffness;
    } catch (const UsageError&) { // nothing to touch in the scene's box
    }
    return found;
}

SceneLimits scene_limits(const PreparedCase& prepared) {
    const Scene& scene = prepared.one.scene;
    const PathsSpec paths = scene.paths.value_or(PathsSpec{});
    return scene_limits(prepared, paths.rate, paths.drive == PathDrive::press ? paths.press : scene.hand.max_force);
}

std::string SceneLimits::text() const {
    if (!(wall > 0))
        return "without damping no sampled loop comes to rest at any stiffness";
    std::string place;
    if (least && least->limit && *least->limit < 0.99 * wall)
        place = fmt::format(" ({}, {:.2g} mm deep, held {}; on a wall below {:.4g} N/m)", name_of(least->place.kind),
                            1e3 * least->place.depth, least->hold.name, wall);
    const std::string through = coupling
                                    ? fmt::format(", felt as {:.4g} N/m through a virtual coupling of {:.4g} N/m, {}",
                                                  felt_stiffness(stiffness, *coupling), *coupling,
                                                  coupled_rests ? "at rest everywhere" : "not at rest everywhere")
                                    : "";
    return fmt::format("{:.6g} N/m{}; a {} comes to rest below {:.4g} N/m{}{}", stiffness, through, hand, limit(),
                       place, coupling ? " without coupling" : "");
}

std::string SceneLimits::warning() const {
    if (stable() || !(stiffness > 0))
        return {};
    return fmt::format("this loop is unstable: force.stiffness is {}; {}", text(),
                       !(wall > 0) ? "set hand.damping or hand.grip_damping"
                       : safe ? fmt::format("a lower force.stiffness, more damping, a faster loop or less delay would "
                                            "hold, or a virtual coupling (hand.coupling.stiffness = \"{:.4g} N/m\": "
                                            "felt as {:.4g} N/m)",
                                            0.99 * *safe, felt_stiffness(stiffness, 0.99 * *safe))
                              : "a lower force.stiffness, more damping, a faster loop or less delay would hold");
}

} // namespace forceshade
