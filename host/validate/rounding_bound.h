// How far rounding may take a computed voxel from the exact one: derived a priori, law by law.
#pragma once

#include "host/field/prepared_case.h"

namespace forceshade {

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
