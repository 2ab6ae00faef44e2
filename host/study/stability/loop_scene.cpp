#include <algorithm>
#include <array>
#include <cmath>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "host/error.h"
#include "host/paths/motions.h"
#include "host/study/stability/loop_place.h"

namespace forceshade::study {
namespace {

double largest_size(const Spread& spread) {
    return spread.shape == Spread::Shape::uniform ? std::max(std::abs(spread.low), std::abs(spread.high))
                                                  : std::abs(spread.value);
}

// m: as deep as the scene's hand goes; where it says nothing of that, or more than half of the way that it goes along,
// a small part of that way.
double depth_of(const Scene& scene, const PathsSpec& paths, double length) {
    constexpr double kSmall = 0.05, kMost = 0.5; // of the way
    const double stiffness = scene.force.stiffness;
    double depth = scene.paths ? largest_size(paths.depth) : std::min(largest_size(paths.depth), kSmall * length);
    if (paths.drive == PathDrive::press)
        depth = std::abs(paths.press) / stiffness;
    if (paths.drive == PathDrive::push)
        depth = glm::length(glm::dvec3(paths.push[0], paths.push[1], paths.push[2])) / stiffness;
    const bool meant = depth > 0 && !(length > 0 && depth > kMost * length);
    return meant ? depth : kSmall * length;
}

// Where a probe that comes down from `high` meets the surface, m; nothing where it does not above `low`. Deep below a
// mesh a proxy might have slid off its side: the way down is taken in small steps.
std::optional<double> surface_height(const PreparedCase& prepared, double x, double y, double low, double high) {
    constexpr int kSteps = 500, kHalvings = 60;
    const auto touches = [&](double z) {
        const glm::dvec3 force = force_at(prepared, {x, y, high}, {x, y, z});
        return glm::dot(force, force) > 0;
    };
    double free = high, inside = high;
    for (int i = 1; i <= kSteps && !touches(inside); ++i) {
        free = inside;
        inside = high + (low - high) * i / kSteps;
    }
    if (free == inside || !touches(inside))
        return std::nullopt;
    for (int i = 0; i < kHalvings; ++i) {
        const double middle = free + (inside - free) / 2;
        (touches(middle) ? inside : free) = middle;
    }
    return inside;
}

void refuse_dead_hand(const Scene& scene) {
    if (!(scene.force.stiffness > 0))
        throw UsageError("force.stiffness is 0: no loop closes without a force");
    if (!(scene.hand.damping + scene.hand.grip_damping > 0))
        throw UsageError("hand.damping and hand.grip_damping are 0: without damping no sampled loop comes to rest at "
                         "any stiffness");
}

} // namespace

LoopPlace scene_place(const PreparedCase& given) {
    // Of the region's length: where the scene names no place, off ridges and bottoms.
    const std::array<double, 3> shares = given.images.mesh ? std::array{0.1, 0.25, 0.0} : std::array{0.25, 0.1, 0.0};
    const Scene& scene = given.one.scene;
    refuse_dead_hand(scene);
    PathsSpec paths = scene.paths.value_or(PathsSpec{});
    if (paths.kind == PathKind::recorded)
        paths.kind = PathKind::strokes;
    LoopPlace place;
    place.name = "scene";
    place.title = "scene's surface";
    place.prepared = given;
    place.prepared.one.scene.force.stiffness = 1;
    if (place.prepared.one.scene.texture)
        place.prepared.one.scene.texture->stiffness /= scene.force.stiffness;
    place.hand = scene.hand;
    place.rate = paths.rate;
    place.stiffness = scene.force.stiffness;
    place.held = scene.paths && paths.closed() && paths.drive == PathDrive::depth;
    const PathRegion region = path_region(paths, given);
    const double length = std::max(region.length, region.width);
    place.depth = depth_of(scene, paths, length);
    const double reach = 2 * std::max(length, place.depth);
    for (const double aside : shares) {
        const double x = region.centre[0] + (paths.centre ? 0 : aside * region.length), y = region.centre[1];
        if (const auto height = surface_height(place.prepared, x, y, region.height - reach, region.height + reach)) {
            place.rest = {x, y, *height - place.depth};
            feel_around(place, {0, 0, 1});
            return place;
        }
    }
    throw UsageError(
        fmt::format("no force meets a probe that comes down at x = {:.4g} m, y = {:.4g} m, so that no hand "
                    "can be in a loop there; name a place over the surface with paths.centre",
                    region.centre[0], region.centre[1]));
}

} // namespace forceshade::study
