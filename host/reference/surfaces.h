// A law's result at one probe position, and its surface data there: facets, height maps, and the column
// above (x, y).
#pragma once

#include "host/reference/elementary.h"
#include "shaders/shared/law.h"

namespace forceshade::reference {

template <typename T> struct Contact {
    T depth;            /* m, 0 out of contact */
    Vector<T> force;    /* N */
    Vector<T> unshaded; /* N: what shading "none" would give */
    Vector<T> proxy;    /* m: the contact point on the nominal surface; the probe itself out of contact */
    layout::uint facet; /* layout::kNoFacet out of contact */
};

/// A law's result for a sample of a path.
template <typename T> struct LawContact {
    Contact<T> contact;
    bool finished = true;   /* the proxy came to rest */
    layout::uint trail = 0; /* hash of its walk; 0 where none is kept */
};

// G2 and L3: the bump of n flat facets inscribed in the reference cylinder, step for step as
// shaders/laws/surfaces.glsl.

template <typename T> struct Facet {
    T height = T(0);   /* m: the nominal surface above the plane at the probe's x */
    T normal_x = T(0); /* 1: unit normal (normal_x, 0, normal_z) */
    T normal_z = T(1);
    layout::uint id = 0; /* 0 .. n-1 from left to right, n for the plane around the bump */
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
    // The chord of a circle descends by (x_i + x_i+1) / (rise_i + rise_i+1): no difference of heights, so no digit
    // cancels.
    const T rises = circle_rise(params.radius, left) + circle_rise(params.radius, right);
    const T descent = rises > T(0) ? (left + right) / rises : T(0);
    facet.height = cylinder_height(params.half_width, params.radius, params.centre_depth, left) - descent * (x - left);
    facet.normal_z = T(1) / sqrt(T(1) + descent * descent);
    facet.normal_x = descent * facet.normal_z;
    return facet;
}

// G3: the gradient of a height map U(x, y), analytic or sampled, step for step as shaders/laws/height_map.glsl.

template <typename T> struct Gradient {
    T x = T(0); /* 1: dU/dx */
    T y = T(0); /* 1: dU/dy */
};

template <typename T> Gradient<T> cylinder_gradient(const layout::MapParams<T>& map, T x, bool dip) noexcept {
    if (!(abs(x) < map.half_width))
        return {};
    const T slope = x / circle_rise(map.radius, x);
    return {dip ? slope : -slope, T(0)};
}

template <typename T> Gradient<T> sine_gradient(const layout::MapParams<T>& map, T x) noexcept {
    return {map.slope * cosine_of_turns(x * map.inverse_length), T(0)};
}

template <typename T> Gradient<T> gaussian_gradient(const layout::MapParams<T>& map, T x, T y) noexcept {
    const T u = x * map.inverse_length;
    const T v = y * map.inverse_length;
    const T steepness = map.slope * exponential_decay(u * u + v * v);
    // Far away u is infinite and the steepness 0: the product would be no number.
    if (!(steepness != T(0)))
        return {};
    return {-(steepness * u), -(steepness * v)};
}

/// Where a coordinate falls between two nodes: the lower node, the upper node and the fraction of the distance.
template <typename T> struct Cell {
    layout::uint low, high;
    T fraction;
};

template <typename T> Cell<T> cell_at(T position, layout::uint nodes) noexcept {
    const layout::uint last = nodes - 1;
    layout::uint low = static_cast<layout::uint>(position);
    if (low > last)
        low = last;
    const T fraction = position - static_cast<T>(low);
    return {low, low < last ? low + 1 : last, fraction < T(1) ? fraction : T(1)};
}

template <typename T> T between(T low, T high, T fraction) noexcept {
    return low + fraction * (high - low);
}

/// G3: bilinear interpolation of the nodes' gradients, (dU/dx, dU/dy) pairs with row 0 at the smallest y; 0 outside the
/// image.
template <typename T>
Gradient<T> sampled_gradient(const layout::MapParams<T>& map, std::span<const T> gradients, T x, T y) noexcept {
    if (!(abs(x) <= map.half_width && abs(y) <= map.half_length))
        return {};
    const Cell<T> across = cell_at((x + map.half_width) * map.nodes_per_x, map.columns);
    const Cell<T> along = cell_at((y + map.half_length) * map.nodes_per_y, map.rows);
    const std::size_t low = std::size_t(along.low) * map.columns;
    const std::size_t high = std::size_t(along.high) * map.columns;
    const auto component = [&](std::size_t offset) {
        return between(between(gradients[2 * (low + across.low) + offset], gradients[2 * (low + across.high) + offset],
                               across.fraction),
                       between(gradients[2 * (high + across.low) + offset],
                               gradients[2 * (high + across.high) + offset], across.fraction),
                       along.fraction);
    };
    return {component(0), component(1)};
}

/// G3: the gradient of a map of the given kind (layout::kMap...).
template <typename T>
Gradient<T> gradient_at(layout::uint kind, const layout::MapParams<T>& map, std::span<const T> gradients, T x,
                        T y) noexcept {
    switch (kind) {
    case layout::kMapCylinder:
    case layout::kMapDip:
        return cylinder_gradient(map, x, kind == layout::kMapDip);
    case layout::kMapSine:
        return sine_gradient(map, x);
    case layout::kMapGaussian:
        return gaussian_gradient(map, x, y);
    case layout::kMapSamples:
        return sampled_gradient(map, gradients, x, y);
    default:
        return {};
    }
}

// What every law needs of the probe's (x, y) alone, step for step as shaders/laws/surfaces.glsl.

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
    const T normal_z = T(1) / sqrt(gradient.x * gradient.x + gradient.y * gradient.y + T(1));
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
    column.on_bump = abs(x) < law.params.half_width;
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
