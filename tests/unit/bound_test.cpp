// The derived rounding bound holds for the oracle in single precision, and is no idle one.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/norm.h"
#include "host/referee/rounding_bound.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

// The largest share of the bound that single precision uses up, over random positions held exactly by a float.
double largest_share(const Scene& scene) {
    PreparedCase prepared;
    prepared.one.scene = scene;
    const RoundingBound bound(prepared, Precision::f32);
    const OwnedLaw<float> single(scene);
    const OwnedLaw<double> exact(scene);
    std::mt19937_64 random(3);
    const auto between = [&](double low, double high) {
        return static_cast<float>(std::lerp(low, high, static_cast<double>(random() >> 11) / 0x1p53));
    };
    double share = 0;
    for (int i = 0; i < 3000; ++i) {
        const float x = between(-0.016, 0.016), z = between(-0.008, 0.006);
        const auto rounded = single(x, 0, z).force;
        const auto truth = exact(x, 0, z);
        if (single(x, 0, z).facet != truth.facet)
            continue; // on a boundary, which validation accounts for
        share = std::max(share, norm(rounded.x - truth.force.x, rounded.y - truth.force.y, rounded.z - truth.force.z) /
                                    bound.at(x, 0, z).force);
    }
    return share;
}

TEST(RoundingBound, HoldsAndIsWithinTwoOrdersOfTheTruth) {
    for (const double radius : {1.0001 * kHalfWidth, kRadii[0], kRadii[2], 1e6 * kHalfWidth}) {
        for (const std::uint32_t facets : {1u, 2u, 3u, 32u})
            for (const Shading shading : {Shading::none, Shading::reference}) {
                const double share = largest_share(bump(radius, facets, shading));
                EXPECT_LE(share, 1) << radius << ' ' << facets;
                EXPECT_GE(share, 1e-3) << radius << ' ' << facets;
            }
        EXPECT_LE(largest_share(cylinder_bump(radius)), 1);
        EXPECT_GE(largest_share(cylinder_bump(radius)), 1e-3);
    }
}

// Rounding R moves the circle's rise near the edge by far more than an ULP.
TEST(RoundingBound, HoldsWhereTheRadiusIsBarelyAboveHalfTheWidth) {
    for (const double excess : {1e-3, 1e-5, 1e-6, 1e-7, 1e-8})
        for (const std::uint32_t facets : {2u, 3u, 32u, 1000u})
            for (const Shading shading : {Shading::none, Shading::reference})
                EXPECT_LE(largest_share(bump((1 + excess) * kHalfWidth, facets, shading)), 1)
                    << excess << ' ' << facets;
}

// One facet is the plane, whose depth is exact.
TEST(RoundingBound, IsThatOfThePlaneWithOneFacet) {
    PreparedCase flat, beside;
    flat.one.scene = bump(kRadii[0], 1);
    beside.one.scene = bump(kRadii[0], 2);
    const RoundingBound on_facet(flat, Precision::f32), on_plane(beside, Precision::f32);
    const double x = 0.001, depth = 1e-6;
    EXPECT_EQ(on_facet.at(x, 0, -depth).depth, on_plane.at(2 * kHalfWidth, 0, -depth).depth);
    EXPECT_LE(on_facet.at(x, 0, -depth).depth, 1e-7 * depth);
    EXPECT_GT(on_plane.at(x, 0, -depth).depth, 1e-5 * depth);
}

} // namespace
} // namespace forceshade::test
