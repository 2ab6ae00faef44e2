// G3: the gradient of a height map U(x, y), analytic or sampled, step for step as shaders/laws/height_map.glsl.
#pragma once

#include "host/reference/circle.h"
#include "host/reference/elementary.h"
#include "shaders/shared/layout.h"

namespace forceshade::reference {

template <typename T> struct Gradient {
    T x = T(0); /* 1: dU/dx */
    T y = T(0); /* 1: dU/dy */
};

template <typename T> Gradient<T> cylinder_gradient(const layout::MapParams<T>& map, T x, bool dip) noexcept {
    if (!(std::abs(x) < map.half_width))
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

/// Where a coordinate falls between two nodes: the lower node, the upper node and the fraction of the way.
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
    if (!(std::abs(x) <= map.half_width && std::abs(y) <= map.half_length))
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

} // namespace forceshade::reference
