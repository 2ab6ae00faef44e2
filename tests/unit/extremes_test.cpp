// Values at the edge of sense: the oracle gives a finite right answer, in both precisions.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host/referee/referee.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

template <typename T> void expect_finite(const Scene& scene) {
    const OwnedLaw<T> law(scene);
    constexpr T kTiny = std::numeric_limits<T>::denorm_min();
    for (const double x : {-1000.0, -kHalfWidth, -0.0126999, -0.004, 0.0, 0.004, 0.0126999, kHalfWidth, 1000.0})
        for (const double z : {-1000.0, -0.01, -1e-9, 0.0, 1e-9, 0.004, 1000.0})
            for (const T nudge : {T(0), kTiny, -kTiny}) {
                const auto contact = law(static_cast<T>(x), T(0), static_cast<T>(z) + nudge);
                for (int i = 0; i < 3; ++i) {
                    EXPECT_TRUE(std::isfinite(contact.force[i])) << x << ' ' << z;
                    EXPECT_TRUE(std::isfinite(contact.unshaded[i]));
                    EXPECT_TRUE(std::isfinite(contact.proxy[i]));
                }
                EXPECT_GE(contact.depth, T(0));
            }
}

std::vector<Scene> all_kinds(double radius, std::uint32_t facets, double stiffness) {
    std::vector<Scene> scenes{cylinder_bump(radius)};
    for (const Shading shading : {Shading::none, Shading::reference})
        for (const DepthReading depth : {DepthReading::vertical, DepthReading::normal})
            for (const ReferenceDirection reference : {ReferenceDirection::normal, ReferenceDirection::radial}) {
                scenes.push_back(bump(radius, facets, shading));
                scenes.back().force.depth = depth;
                scenes.back().force.reference = reference;
            }
    for (const MapFunction function : {MapFunction::cylinder, MapFunction::dip}) {
        HeightMapSpec map;
        map.function = function;
        map.width = 2 * kHalfWidth;
        map.radius = radius;
        scenes.push_back(height_map(map));
    }
    for (Scene& scene : scenes)
        scene.force.stiffness = stiffness;
    return scenes;
}

TEST(Extremes, FiniteForAllRadiiFacetsAndStiffnesses) {
    for (const double radius : {kHalfWidth, std::nextafter(kHalfWidth, 1.0), kRadii[0], 1e9 * kHalfWidth})
        for (const std::uint32_t facets : {1u, 2u, 3u, 1000000u})
            for (const double stiffness : {1e-9, 1e3, 1e12})
                for (const Scene& scene : all_kinds(radius, facets, stiffness)) {
                    expect_finite<float>(scene);
                    expect_finite<double>(scene);
                }
}

TEST(Extremes, PlaneIsASpring) {
    const OwnedLaw<double> law(bump(kRadii[0], 1));
    EXPECT_EQ(law(0.003, 0, -0.002).force.z, 1000 * 0.002);
    EXPECT_EQ(law(0.003, 0, -0.002).force.x, 0);
    EXPECT_EQ(law(0.003, 0, 0).force.z, 0);
    EXPECT_EQ(law(0.003, 0, 0.001).force.z, 0);
    EXPECT_EQ(law(0.003, 0, 0).facet, layout::kNoFacet);
    EXPECT_EQ(law(0.003, 0, -1e-12).facet, 0u);
    EXPECT_EQ(law(0.02, 0, -1e-12).facet, 1u);
}

TEST(Extremes, HalfCircle) {
    // R = a: the bump is a half circle, its rim vertical, its axis on the plane.
    const OwnedLaw<double> law(bump(kHalfWidth, 2, Shading::reference));
    const auto force = law(0.0, 0, 0.001).force;
    EXPECT_NEAR(force.z, 1000 * (kHalfWidth - 0.001), 1e-12);
    EXPECT_NEAR(law(kHalfWidth / 2, 0, 0).force.x / law(kHalfWidth / 2, 0, 0).force.z, std::tan(std::asin(0.5)), 1e-14);
    const OwnedLaw<double> real(cylinder_bump(kHalfWidth));
    EXPECT_EQ(real(0, 0, 0).force.z, 1000 * kHalfWidth) << "on the axis the force points up";
    EXPECT_EQ(real(0, 0, 0).force.x, 0);
}

TEST(Extremes, NearlyFlatCylinderKeepsItsDigits) {
    // R = 10^9 a: U(0) = a^2 / 2R to nine digits and more; single precision must find it too.
    const double radius = 1e9 * kHalfWidth, height = kHalfWidth * kHalfWidth / (2 * radius);
    const OwnedLaw<float> law(bump(radius, 2));
    EXPECT_NEAR(double(law(0, 0, 0).depth) / height, 1, 1e-6);
    const OwnedLaw<float> real(cylinder_bump(radius));
    EXPECT_NEAR(double(real(0, 0, 0).depth) / height, 1, 1e-6);
    EXPECT_NEAR(double(real(0, 0, -0.001f).force.z), 2.0, 1e-6) << "plane and cylinder each carry 1 N";
}

TEST(Extremes, MillionFacetsFollowTheCircle) {
    const OwnedLaw<float> fine(bump(kRadii[0], 1000000));
    const OwnedLaw<double> exact(bump(kRadii[0], 1000000));
    for (const double x : {-0.0126, -0.009, -0.0031, 0.0, 0.0049, 0.0111}) {
        const auto single = fine(static_cast<float>(x), 0, -0.001f).force;
        const auto twice = exact(x, 0, -0.001).force;
        const double angle = std::asin(x / kRadii[0]);
        EXPECT_NEAR(std::atan2(twice.x, twice.z), angle, 2e-6);
        EXPECT_NEAR(std::atan2(single.x, single.z), angle, 4e-6);
    }
}

TEST(Extremes, DenormalDepthGivesDenormalForce) {
    Scene scene = bump(kRadii[0], 1);
    scene.force.stiffness = 1;
    const float tiny = 64 * std::numeric_limits<float>::denorm_min();
    EXPECT_EQ(OwnedLaw<float>(scene)(0, 0, -tiny).force.z, tiny);
    EXPECT_EQ(OwnedLaw<double>(scene)(0, 0, -5e-320).force.z, 5e-320);
}

TEST(Extremes, BoundariesBelongToTheFacetOnTheirRight) {
    const OwnedLaw<double> law(bump(kRadii[0], 3));
    for (std::uint32_t i = 0; i < 3; ++i) {
        const double vertex = law.tables.facet_vertices[i];
        EXPECT_EQ(law(vertex, 0, -0.001).facet, i);
        EXPECT_EQ(law(std::nextafter(vertex, -1.0), 0, -0.001).facet, i == 0 ? 3u : i - 1);
    }
    EXPECT_EQ(law(kHalfWidth, 0, -0.001).facet, 3u);
}

TEST(Extremes, AxisOfTheCylinderIsNoPole) {
    const OwnedLaw<float> law(cylinder_bump(kHalfWidth));
    for (const float x : {0.0f, 1e-30f, -1e-25f, 1e-20f, 1e-18f}) {
        const auto force = law(x, 0, 0).force;
        EXPECT_NEAR(std::hypot(double(force.x), double(force.z)), 1000 * kHalfWidth, 1e-5) << x;
    }
}

} // namespace
} // namespace forceshade::test
