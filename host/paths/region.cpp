#include "host/paths/region.h"

#include <algorithm>

#include <fmt/format.h>

#include "host/error.h"
#include "host/field/scene_mesh.h"

namespace forceshade {
namespace {

constexpr double kBeyond = 1.2;      // a path's length, of the feature's
constexpr double kGaussianRadii = 4; // a Gaussian's width: at its ends it has fallen to height e^-4
constexpr double kInnerShare = 0.05; // a spiral's smallest radius, of its length
constexpr double kBoundLengths = 10; // a probe that has left, in lengths
constexpr double kLeastBound = 0.1;  // m

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

} // namespace

PathRegion path_region(const PathsSpec& paths, const PreparedCase& prepared) {
    const Feature feature = feature_of(prepared);
    PathRegion region;
    region.centre = paths.centre.value_or(feature.middle);
    region.height = paths.height.value_or(feature.top);
    region.length = paths.length.value_or(kBeyond * feature.along);
    region.width = paths.width.value_or(paths.length ? *paths.length : kBeyond * feature.across);
    region.inner = paths.inner.value_or(kInnerShare * region.length);
    region.bound = paths.bound.value_or(std::max(kLeastBound, kBoundLengths * region.length));
    if (paths.kind == PathKind::spiral && region.inner > region.length / 2)
        throw UsageError(fmt::format("paths.inner, a spiral's smallest radius, is {} m, and its largest, half of "
                                     "length, {} m",
                                     region.inner, region.length / 2));
    return region;
}

} // namespace forceshade
