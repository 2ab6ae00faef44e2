#include "host/touch/true_force.h"

#include <cmath>
#include <memory>

#include <fmt/format.h>

#include "host/mesh/mesh.h"
#include "host/touch/force_at.h"

namespace forceshade {
namespace {

ForceAt best_truth(const PreparedCase& scene, const TouchScale& scale) {
    const auto prepared = std::make_shared<PreparedCase>(scene);
    prepared->one.scene.force.shading = shadings_of(scene).back().first;
    const auto force = std::make_shared<ContactForce>(*prepared, scale);
    return [prepared, force](const TouchPlace& place) { return (*force)(place); };
}

} // namespace

std::vector<NamedShading> shadings_of(const PreparedCase& scene) {
    std::vector<NamedShading> shadings{{Shading::none, "none"}};
    const SurfaceKind kind = scene.one.scene.surface.kind;
    if (kind == SurfaceKind::bump)
        shadings.push_back({Shading::reference, "reference"});
    if (kind == SurfaceKind::height_map)
        shadings.push_back({Shading::height_map, "height_map"});
    if (kind != SurfaceKind::mesh)
        return shadings;
    const PolygonSoup& polygons = scene.images.mesh->mesh.polygons;
    shadings.push_back({Shading::morgenbesser, "morgenbesser"});
    if (polygons.corners.size() == 3 * polygons.facets())
        shadings.push_back({Shading::barycentric, "barycentric"});
    shadings.insert(shadings.end(), {{Shading::two_pass, "two_pass"}, {Shading::mean_value, "mean_value"}});
    return shadings;
}

ForceAt cylinder_force(const Scene& scene) {
    const bool normal = scene.force.depth == DepthReading::normal;
    return [normal, own = SmoothCylinder(scene)](const TouchPlace& place) {
        const glm::dvec3& at = place.at;
        double depth = reference::cylinder_height(own.half, own.radius, own.centre_depth, at.x) - at.z;
        if (!(depth > 0))
            return glm::dvec3(0);
        glm::dvec3 direction(0, 0, 1);
        if (std::abs(at.x) < own.half)
            direction = {at.x / own.radius, 0, reference::circle_rise(own.radius, at.x) / own.radius};
        if (normal)
            depth *= direction.z;
        return own.stiffness * depth * direction;
    };
}

TrueForce true_force(const PreparedCase& prepared, const TouchScale& scale) {
    const Scene& scene = prepared.one.scene;
    if (scene.surface.kind == SurfaceKind::bump && !scene.texture)
        return {cylinder_force(scene), kSmoothShape, true};
    return {best_truth(prepared, scale), fmt::format("double precision of {}", shadings_of(prepared).back().second),
            false};
}

} // namespace forceshade
