#include "host/scene/scene.h"

namespace forceshade {

namespace {

bool depends_on_y(const HeightMapSpec& map) {
    return map.function == MapFunction::gaussian || map.function == MapFunction::file;
}

} // namespace

bool depends_on_y(const Scene& scene) {
    const bool surface = scene.surface.kind == SurfaceKind::height_map && scene.force.shading == Shading::height_map &&
                         depends_on_y(scene.surface.map);
    return surface || (scene.texture && depends_on_y(scene.texture->map));
}

} // namespace forceshade
