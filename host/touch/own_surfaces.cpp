#include "host/touch/own_surfaces.h"

namespace forceshade {

PreparedCase own_case(const OwnSurface& own, const glm::dvec3& shift) {
    PreparedCase prepared;
    Scene& scene = prepared.one.scene;
    SurfaceSpec& surface = scene.surface;
    surface.kind = own.kind;
    surface.width = surface.map.width = 2 * kOwnHalfWidth;
    surface.radius = surface.map.radius = own.radius;
    surface.facets = own.facets;
    surface.map.function = own.function;
    if (own.function == MapFunction::sine) {
        surface.map.width = kOwnWavelength;
        surface.map.height = 0.001;
    }
    scene.force.stiffness = own.stiffness;
    if (own.shaded)
        scene.force.shading = own.kind == SurfaceKind::height_map ? Shading::height_map
                              : own.kind == SurfaceKind::mesh     ? Shading::mean_value
                                                                  : Shading::reference;
    if (own.kind == SurfaceKind::mesh) {
        surface.mesh.file = "bump";
        prepared.images.mesh = bump_mesh({kOwnHalfWidth, own.radius, own.facets, own.rows}, shift);
    }
    return prepared;
}

} // namespace forceshade
