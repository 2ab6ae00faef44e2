// Scenes and laws for tests.
#pragma once

#include <array>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/reference/contact.h"
#include "host/scene/scene.h"

namespace forceshade::test {

inline constexpr double kMil = 25.4e-6;                                    /* m */
inline constexpr double kHalfWidth = 500 * kMil;                           /* m: a of the paper */
inline constexpr double kRadii[] = {600 * kMil, 1000 * kMil, 1400 * kMil}; /* m */

inline Scene bump(double radius, std::uint32_t facets, Shading shading = Shading::none) {
    Scene scene;
    scene.surface.kind = SurfaceKind::bump;
    scene.surface.width = 2 * kHalfWidth;
    scene.surface.radius = radius;
    scene.surface.facets = facets;
    scene.force.shading = shading;
    scene.grid.size = {1, 1, 1};
    return scene;
}

inline Scene cylinder_bump(double radius) {
    Scene scene = bump(radius, 1);
    scene.surface.kind = SurfaceKind::cylinder_bump;
    return scene;
}

inline Scene height_map(const HeightMapSpec& map) {
    Scene scene = bump(kRadii[0], 1);
    scene.surface.kind = SurfaceKind::height_map;
    scene.surface.map = map;
    scene.force.shading = Shading::height_map;
    return scene;
}

/// A law that owns its tables.
template <typename T> struct OwnedLaw {
    FieldTables<T> tables;
    explicit OwnedLaw(const Scene& scene, const SceneImages& images = {})
        : tables(make_tables<T>(scene, images, Extent::everything)) {}
    reference::Contact<T> operator()(T x, T y, T z) const { return reference::evaluate(tables.law(), {x, y, z}); }
};

} // namespace forceshade::test
