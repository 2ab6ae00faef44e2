// How far rounding may take a computed force from the exact one: derived a priori, law by law.
#pragma once

#include "host/field/prepared_case.h"

namespace forceshade {

/// First-order bounds by counting roundings along each law's formula. Every operation may be off by as much as Vulkan
/// lets a device be (+ - * half an ULP, / 2.5 ULP, sqrt about 3 ULP), so one bound serves hardware and CPU alike. With
/// u the unit roundoff (2^-24, 2^-53), s the slope of facet or map, and every coordinate taken as exact:
///  - a height of G1 or G2 is off by at most 64 u (U(0) + s |x|), the depth by 64 u (U(0) + s |x| + d);
///  - a unit normal by 64 u (1 + s), a radial direction by 64 u (1 + (|z| + c) / r);
///  - R - r of L2 by 64 u (a^2 + x^2 + |z| (|z| + 2 c)) / (R + r);
///  - the gradient of a sine by 64 u s (1 + turns), of a Gaussian by 64 u s (1 + (x^2 + y^2) / radius^2), of samples by
///  64 u s (1 + columns + rows).
/// 64 is the next power of two above the longest chain: U of a vertex (17 half ULPs), the chord (15), the normal (2 *
/// 15 + 13) and the product.
class ForceBound {
public:
    /// `unit_roundoff`: 2^-24 for single precision, 2^-53 for double. The case must outlive the bound.
    ForceBound(const PreparedCase& prepared, double unit_roundoff);

    /// N: a bound on |F - F_exact| at a sample position in m.
    double at(double x, double y, double z) const;

private:
    const Scene& scene_;
    FieldTables<double> tables_;
    double roundoff_;
    double largest_map_slope_ = 0, largest_texture_slope_ = 0;
};

} // namespace forceshade
