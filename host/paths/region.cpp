#include "host/paths/region.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/prepare/prepared_case.h"

namespace forceshade {
namespace {

constexpr double kBeyond = 1.2;      // a path's length, of the feature's
constexpr double kUpon = 0.5;        // the same where a hand that presses would fall off a mesh's rim
constexpr double kGaussianRadii = 4; // a Gaussian's width: at its ends it has fallen to height e^-4
constexpr double kInnerShare = 0.05; // a spiral's smallest radius, of its length
constexpr double kBoundLengths = 10; // a probe that has left, in lengths
constexpr double kLeastBound = 0.1;  // m
constexpr double kStretch = 1e-3;    // of a path's length

struct Feature {
    std::array<double, 2> middle{}; /* m */
    double top = 0;                 /* m */
    double along = 0, across = 0;   /* m: widths in x and y */
};

Feature map_feature(const HeightMapSpec& map) {
    switch (map.function) {
    case MapFunction::cylinder:
    case MapFunction::dip:
    case MapFunction::sine:
        return {{}, 0, map.width, map.width};
    case MapFunction::gaussian:
        return {{}, 0, kGaussianRadii * map.radius, kGaussianRadii * map.radius};
    case MapFunction::file:
        break;
    }
    return {{}, 0, map.size[0], map.size[1]};
}

Feature mesh_feature(const SceneMesh& mesh) {
    const MeshBox box = bounding_box(mesh.mesh.polygons);
    const auto middle = [&](std::size_t i) { return box.low[i] + (box.high[i] - box.low[i]) / 2; };
    return {{middle(0), middle(1)}, box.high[2], box.high[0] - box.low[0], box.high[1] - box.low[1]};
}

Feature feature_of(const PreparedCase& prepared) {
    const SurfaceSpec& surface = prepared.one.scene.surface;
    if (surface.kind == SurfaceKind::mesh)
        return mesh_feature(*prepared.images.mesh);
    if (surface.kind == SurfaceKind::height_map)
        return map_feature(surface.map);
    return {{}, 0, surface.width, surface.width};
}

// Without its sign.
double largest(const Spread& spread) {
    constexpr double kDeviations = 8;
    switch (spread.shape) {
    case Spread::Shape::fixed:
        return std::abs(spread.value);
    case Spread::Shape::normal:
        return std::abs(spread.value) + kDeviations * spread.sd;
    case Spread::Shape::uniform:
        break;
    }
    return std::max(std::abs(spread.low), std::abs(spread.high));
}

} // namespace

PathRegion path_region(const PathsSpec& paths, const PreparedCase& prepared) {
    const Feature feature = feature_of(prepared);
    PathRegion region;
    region.centre = paths.centre.value_or(feature.middle);
    region.height = paths.height.value_or(feature.top);
    const bool falls = prepared.one.scene.surface.kind == SurfaceKind::mesh && paths.drive != PathDrive::depth;
    const double share = falls ? kUpon : kBeyond;
    region.length = paths.length.value_or(share * feature.along);
    region.width = paths.width.value_or(paths.length ? *paths.length : share * feature.across);
    region.inner = paths.inner.value_or(kInnerShare * region.length);
    region.bound = paths.bound.value_or(std::max(kLeastBound, kBoundLengths * region.length));
    const double feature_length = kBeyond * std::max(feature.along, feature.across);
    const double over = region.length > 0 ? region.length : region.width > 0 ? region.width : feature_length;
    region.stretch = paths.stretch.value_or(kStretch * over);
    if (paths.kind == PathKind::spiral && region.inner > region.length / 2)
        throw UsageError(fmt::format("paths.inner, a spiral's smallest radius, is {} m, and its largest, half of "
                                     "length, {} m",
                                     region.inner, region.length / 2));
    return region;
}

PathRegion recorded_region(const PreparedCase& prepared) {
    PathsSpec paths = prepared.one.scene.paths.value_or(PathsSpec{});
    paths.kind = PathKind::recorded;
    return path_region(paths, prepared);
}

float single_stretch(const PathRegion& region) {
    constexpr double kLeast = 1e-18, kMost = 1e18;
    return static_cast<float>(std::clamp(region.stretch, kLeast, kMost));
}

double farthest_coordinate(const PathsSpec& paths, const PathRegion& region) {
    constexpr double kPeak = 6; // of a sum of harmonics, in root mean squares, and more
    const double reach = 0.5 * (region.length + region.width);
    const double shaken = kPeak * largest(paths.tremor_amplitude);
    const double depth = std::max(largest(paths.depth), paths.depth_back ? largest(*paths.depth_back) : 0);
    const double across =
        std::max(std::abs(region.centre[0]), std::abs(region.centre[1])) + reach + largest(paths.offset);
    const double up = std::abs(region.height) + depth + std::max(paths.lift.value_or(0), depth);
    const double away = paths.closed() ? region.bound + std::abs(paths.start_depth) : 0;
    return std::max(across, up) + shaken + away;
}

} // namespace forceshade
