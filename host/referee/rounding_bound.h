// Distances between floating-point numbers in units in the last place.
#pragma once

#include <bit>
#include <cstdint>
#include <cstdlib>
#include <type_traits>

#include "host/prepare/prepared_case.h"

namespace forceshade {

/// How many representable numbers lie between a and b, counting one end; +0 and -0 are one apart. NaN is far from
/// everything, itself too.
template <typename T> std::uint64_t ulp_distance(T a, T b) {
    using Bits = std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t>;
    if (a != a || b != b)
        return UINT64_MAX;
    // Numbers in order, so that their places subtract: negative ones count down from the middle.
    const auto place = [](T value) {
        constexpr Bits kSign = Bits(1) << (8 * sizeof(T) - 1);
        const Bits bits = std::bit_cast<Bits>(value);
        return bits & kSign ? kSign - 1 - (bits & ~kSign) : bits + kSign;
    };
    const Bits first = place(a), second = place(b);
    return first > second ? first - second : second - first;
}

// How far rounding may take a computed voxel from the exact one: derived a priori, law by law.

/// How far each channel of a voxel may be off.
struct Bound {
    double force = 0;     /* N: |F - F_exact| */
    double magnitude = 0; /* N: | |F| - |F_exact| |; says more than `force` where the direction is ill conditioned */
    double unshaded = 0;  /* N */
    double depth = 0;     /* m */
    double proxy = 0;     /* m */
};

/// The sum of the bounds.
Bound operator+(const Bound& a, const Bound& b);
Bound operator*(double factor, const Bound& bound);

/// First-order bounds by counting roundings along each law's formula. In single precision every operation may be off by
/// as much as Vulkan lets a device be (+ - * half an ULP, / 2.5 ULP, sqrt about 3 ULP), so one bound serves hardware
/// and CPU alike. Vulkan's table of ULPs is for single precision: in double + - * / and sqrt are taken to round as IEEE
/// 754 says, which holds for the software device, and is tried wherever else a device is validated. With u the unit
/// roundoff (2^-24, 2^-53), s the slope of facet or map, and every coordinate taken as exact:
///  - a height of G1 or G2 is off by at most 64 u (U(0) + s a), and exact beside the bump or with one facet; the depth
///  by that and 64 u (|z| + d). Where R is barely above a vertex, R and a being rounded moves the circle's rise there
///  by up to 4 u R^2 / rise, never more than 2 sqrt(u) R; slope and height of the facet follow;
///  - a unit normal by 64 u (1 + s), a radial direction by 64 u (1 + (|x| + |z| + c) / r);
///  - R - r of L2 by 64 u (a^2 + x^2 + |z| (|z| + 2 c)) / (R + r);
///  - the gradient of a cylinder by 64 u (1 + s) sqrt(1 + s^2), of a sine by 64 u s (1 + turns), of a Gaussian by 64 u
///  s (1 + (x^2 + y^2) / radius^2), of samples by 64 u s (1 + columns + rows), s there the largest; the normal of a map
///  by that over sqrt(1 + s^2).
/// 64 is the next power of two above the longest chain: U of a vertex (17 half ULPs), the chord (15), the normal (2 *
/// 15 + 13) and the product. Below the smallest normal number m nothing is relative, and hardware may take such numbers
/// for zero: each depth, direction and force is off by 4 m more, a gradient by 32 m (1 + s). No direction is off by
/// more than 2, whatever its condition.
class RoundingBound {
public:
    /// The case must outlive the bound.
    RoundingBound(const PreparedCase& prepared, Precision precision);

    /// The bound at a sample position in m.
    Bound at(double x, double y, double z) const;

    /// How much the channels may differ over a distance in m, on either side of an edge's neighbourhood.
    Bound over(double distance) const;

    /// The law in double precision.
    layout::Law<double> law() const { return tables_.law(); }

private:
    const Scene& scene_;
    FieldTables<double> tables_;
    double unit_; // 64 u
    double tiny_; // 4 m
    double steepest_map_ = 0, steepest_texture_ = 0;
};

} // namespace forceshade
