// What every law needs of the probe's (x, y) alone, step for step as shaders/laws/column.glsl.
#pragma once

#include "host/reference/faceted_bump.h"
#include "host/reference/height_map.h"
#include "host/reference/vector.h"

namespace forceshade::reference {

template <typename T> struct Column {
    T x, y;                       /* m */
    Facet<T> facet;               /* L3: the nominal surface below the probe */
    Vector<T> direction{0, 0, 1}; /* L4, L5: the smooth surface's unit normal above the probe */
    Gradient<T> texture;          /* L8 */
    bool on_bump = false;         /* |x| < a */
};

/// G1: N(x) on the bump, z elsewhere.
template <typename T> Vector<T> reference_normal(T radius, T x, bool on_bump) noexcept {
    if (!on_bump)
        return {T(0), T(0), T(1)};
    return {x / radius, T(0), circle_rise(radius, x) / radius};
}

/// L5: the unit normal of a height map with this gradient.
template <typename T> Vector<T> map_normal(Gradient<T> gradient) noexcept {
    const T normal_z = T(1) / std::sqrt(gradient.x * gradient.x + gradient.y * gradient.y + T(1));
    return {-(gradient.x * normal_z), -(gradient.y * normal_z), normal_z};
}

/// The part of a law that does not depend on z, for a probe at (x, y) in m.
template <typename T> Column<T> column_at(const layout::Law<T>& law, T x, T y) noexcept {
    const layout::Features& features = law.features;
    Column<T> column;
    column.x = x;
    column.y = y;
    if (features.surface == layout::kSurfaceMesh)
        return column;
    column.on_bump = std::abs(x) < law.params.half_width;
    if (features.surface == layout::kSurfaceBump)
        column.facet = facet_at(law, x);
    if (features.shading == layout::kShadingReference && features.reference == layout::kReferenceNormal)
        column.direction = reference_normal(law.params.radius, x, column.on_bump);
    if (features.shading == layout::kShadingHeightMap)
        column.direction = map_normal(gradient_at(features.map, law.params.map, law.map_gradients, x, y));
    column.texture = gradient_at(features.texture, law.params.texture, law.texture_gradients, x, y);
    return column;
}

} // namespace forceshade::reference
