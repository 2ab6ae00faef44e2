// G1: the reference cylinder, step for step as shaders/laws/circle.glsl.
#pragma once

#include <cmath>

namespace forceshade::reference {

/// sqrt(R^2 - x^2), m: how far the circle stands above its axis at x, |x| <= R.
template <typename T> T circle_rise(T radius, T x) noexcept {
    return std::sqrt((radius - x) * (radius + x));
}

/// G1: U(x), m, the cylinder above the nominal plane; 0 for |x| >= a. `centre_depth` is sqrt((R-a)(R+a)), m.
template <typename T> T cylinder_height(T half_width, T radius, T centre_depth, T x) noexcept {
    const T product = (half_width - x) * (half_width + x);
    if (!(product > T(0)))
        return T(0);
    return product / (circle_rise(radius, x) + centre_depth);
}

} // namespace forceshade::reference
