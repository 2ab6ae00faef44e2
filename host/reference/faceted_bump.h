// G2 and L3: the bump of n flat facets inscribed in the reference cylinder, step for step as
// shaders/laws/faceted_bump.glsl.
#pragma once

#include "host/reference/circle.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

template <typename T> struct Facet {
    T height = T(0);   /* m: the nominal surface above the plane at the probe's x */
    T normal_x = T(0); /* 1: unit normal (normal_x, 0, normal_z) */
    T normal_z = T(1);
    layout::uint id = 0; /* 0 .. n-1 from left to right, n for the plane beside the bump */
};

/// G2: the facet [x_i, x_i+1) that holds x, by bisection; needs x_0 <= x < x_n.
template <typename T> layout::uint facet_index(std::span<const T> vertices, T x, layout::uint facets) noexcept {
    layout::uint low = 0;
    layout::uint high = facets;
    while (high - low > 1) {
        const layout::uint middle = low + (high - low) / 2;
        if (vertices[middle] <= x)
            low = middle;
        else
            high = middle;
    }
    return low;
}

/// L3: the facet below the probe.
template <typename T> Facet<T> facet_at(const layout::Law<T>& law, T x) noexcept {
    const layout::LawParams<T>& params = law.params;
    Facet<T> facet;
    facet.id = params.facets;
    if (!(x >= -params.half_width && x < params.half_width))
        return facet;
    facet.id = facet_index(law.facet_vertices, x, params.facets);
    const T left = law.facet_vertices[facet.id];
    const T right = law.facet_vertices[facet.id + 1];
    // The chord of a circle descends by (x_i + x_i+1) / (rise_i + rise_i+1): no difference of heights, so nothing
    // cancels.
    const T rises = circle_rise(params.radius, left) + circle_rise(params.radius, right);
    const T descent = rises > T(0) ? (left + right) / rises : T(0);
    facet.height = cylinder_height(params.half_width, params.radius, params.centre_depth, left) - descent * (x - left);
    facet.normal_z = T(1) / std::sqrt(T(1) + descent * descent);
    facet.normal_x = descent * facet.normal_z;
    return facet;
}

} // namespace forceshade::reference
