// How far rounding may take each part of a law, in units of the roundoff u (2^-24, 2^-53): one table for all laws.
// Tests recompute every line but the first three by running the law's own code in affine arithmetic
// (tests/unit/law_bounds_test.cpp, tests/mesh/mesh_bounds_test.cpp), and fail where a factor is too small, or twice too
// large.
#pragma once

namespace forceshade::roundings {

/// Single precision as Vulkan's table of precisions allows it: + - * to the nearest number, 1 u; / to 2.5 ULP, 5 u; a
/// square root as one divided by an inverse root to 2 ULP, 9 u. In double precision all of these are taken to round as
/// IEEE 754 says, 1 u, which holds for the software device, and is tried wherever else a device is validated.
struct Factor {
    double f32, f64;
};

// What is handed to a law, of its own size.
inline constexpr Factor kGiven{1, 0};   // as a scene states it: radius, width, stiffness
inline constexpr Factor kMade{1, 6};    // as the host makes it of that in double: an arc tangent, a sine and more
inline constexpr Factor kCircle{4, 12}; // G1: R^2 - x^2, of R^2: two of R (given), two of x (made)

// Bumps, with U(x) the height at a facet's left vertex, s its slope.
inline constexpr Factor kFacetHeight{23, 10}; // G2: of U + s a. The chord's root 9, / 5 and 4, then / or * and 2 sums
inline constexpr Factor kFacetNormal{25, 7};  // L3: of 1. Root 9, / 5, 2 products; half of the chord's 17
inline constexpr Factor kReference{16, 4};    // L4: of 1. Root 9, / 5, half of 3
inline constexpr Factor kRadial{17, 7};       // L2, L4: of 1 + c / r. Root 9, / 5, half of 3; c is made
// L2: of (a^2 + x^2 + |z| (|z| + 2 c)) / (R + r). Root 9, / 5, 3; two that are made.
inline constexpr Factor kCylinderDepth{19, 20};

// Height maps and textures, with s the slope.
inline constexpr Factor kCylinderSlope{16, 4}; // G3: of s. Root 9, / 5, half of 3
inline constexpr Factor kSine{9, 14};          // G3: of the largest s. The series, a product, an amplitude that is made
inline constexpr Factor kTurns{13, 44};    // G3: of the largest s and a turn. 2 pi times one that is made, a product
inline constexpr Factor kGaussian{9, 25};  // G3: of s (1 + (x^2 + y^2) / radius^2). The series; the radius is made
inline constexpr Factor kSamples{9, 25};   // G3: of the largest s (1 + columns + rows). Where between nodes: 2 and made
inline constexpr Factor kMapNormal{17, 5}; // L5: of 1. Root 9, / 5, half of 3, a product

// Meshes, with P the probe's largest coordinate, d its depth, l an edge's length.
inline constexpr Factor kNearest{40, 40}; // L6: of 1 + P, of d / l more on an edge. Which side of an edge 15, a foot 10
inline constexpr Factor kPlace{2, 2};     // L6: of a point and the centre, m. Two sums, or one and what is given
inline constexpr Factor kMorgenbesser{27, 21}; // L7: of the length, and 1 more a corner. Two roots, a product
inline constexpr Factor kBarycentric{6, 5}; // L7: of the length times 1 + aspect. Areas cancel: 3 of their longest side
inline constexpr Factor kMeanValue{11, 8};  // L7: of the same; two roots and two quotients on the way
inline constexpr double kTurn = 2;          // L7: turn of a normal, per displacement of the point over the height
inline constexpr Factor kTilt{20, 12};      // L9: of 1 + s. Root 9, / 5, the projection

// Forces.
inline constexpr Factor kLength{17, 5}; // of 1: a unit vector's length. Root 9, / 5, half of 3, a product
inline constexpr Factor kForce{3, 2};   // of K d: K is given, two products

} // namespace forceshade::roundings
