// L1 to L5 and L8 on the oracle: who carries which part of the force, what is continuous, what symmetry keeps.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/norm.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

double magnitude(const reference::Vector<double>& force) {
    return norm(force.x, force.y, force.z);
}

std::vector<Scene> many_bumps() {
    std::vector<Scene> scenes;
    for (const double radius : {kHalfWidth, kRadii[0], kRadii[1], kRadii[2]})
        for (const std::uint32_t facets : {1u, 2u, 3u, 16u})
            for (const DepthReading depth : {DepthReading::vertical, DepthReading::normal})
                for (const ReferenceDirection reference : {ReferenceDirection::normal, ReferenceDirection::radial}) {
                    scenes.push_back(bump(radius, facets, Shading::reference));
                    scenes.back().force.depth = depth;
                    scenes.back().force.reference = reference;
                }
    return scenes;
}

template <typename Check> void at_random_points(const Check& check) {
    std::mt19937_64 random(1996);
    const auto between = [&](double low, double high) {
        return std::lerp(low, high, static_cast<double>(random() >> 11) / 0x1p53);
    };
    for (int i = 0; i < 500; ++i)
        check(between(-0.016, 0.016), between(-0.01, 0.01), between(-0.01, 0.008));
}

TEST(Contact, PlaneIsASpring) {
    const OwnedLaw<double> law(bump(kRadii[0], 1));
    EXPECT_EQ(law(0.003, 0, -0.002).force.z, 1000 * 0.002);
    EXPECT_EQ(law(0.003, 0, -0.002).force.x, 0);
    EXPECT_EQ(magnitude(law(0.003, 0, 0).force), 0);
    EXPECT_EQ(magnitude(law(0.003, 0, 0.001).force), 0);
    EXPECT_EQ(law(0.003, 0, 0).facet, layout::kNoFacet);
    EXPECT_EQ(law(0.003, 0, -1e-12).facet, 0u);
    EXPECT_EQ(law(0.02, 0, -1e-12).facet, 1u);
}

TEST(Contact, ShadingKeepsTheMagnitude) {
    for (const Scene& scene : many_bumps()) {
        const OwnedLaw<double> law(scene);
        at_random_points([&](double x, double y, double z) {
            const auto contact = law(x, y, z);
            EXPECT_NEAR(magnitude(contact.force), magnitude(contact.unshaded), 1e-15 * magnitude(contact.unshaded));
        });
    }
}

TEST(Contact, UnshadedChannelIsTheUnshadedScene) {
    for (Scene scene : many_bumps()) {
        const OwnedLaw<double> shaded(scene);
        scene.force.shading = Shading::none;
        const OwnedLaw<double> plain(scene);
        at_random_points([&](double x, double y, double z) {
            EXPECT_EQ(shaded(x, y, z).unshaded, plain(x, y, z).force);
            EXPECT_EQ(shaded(x, y, z).depth, plain(x, y, z).depth);
            EXPECT_EQ(shaded(x, y, z).facet, plain(x, y, z).facet);
        });
    }
}

TEST(Contact, MirrorAndStiffness) {
    for (Scene scene : many_bumps()) {
        const OwnedLaw<double> law(scene);
        scene.force.stiffness *= 8; // a power of two: exact
        const OwnedLaw<double> stiffer(scene);
        at_random_points([&](double x, double y, double z) {
            const auto here = law(x, y, z).force, there = law(-x, y, z).force, strong = stiffer(x, y, z).force;
            // A facet's height is reckoned from its left end, so mirror images differ by rounding.
            EXPECT_NEAR(here.x, -there.x, 1e-14);
            EXPECT_NEAR(here.z, there.z, 1e-14);
            EXPECT_EQ(strong.x, 8 * here.x);
            EXPECT_EQ(strong.z, 8 * here.z);
        });
    }
}

TEST(Contact, ShadedDirectionIsTheCircles) {
    const OwnedLaw<double> law(bump(kRadii[1], 3, Shading::reference));
    for (const double x : {-0.012, -0.004, 0.0, 0.0077, 0.0126}) {
        const auto force = law(x, 0, -0.001).force;
        EXPECT_NEAR(std::atan2(force.x, force.z), std::asin(x / kRadii[1]), 1e-15);
    }
    EXPECT_EQ(law(kHalfWidth, 0, -0.001).force.x, 0) << "beside the bump the force is vertical";
}

TEST(Contact, RadialDirectionPointsFromTheAxis) {
    Scene scene = bump(kRadii[1], 3, Shading::reference);
    scene.force.reference = ReferenceDirection::radial;
    const OwnedLaw<double> law(scene);
    const double axis = std::sqrt((kRadii[1] - kHalfWidth) * (kRadii[1] + kHalfWidth));
    const auto force = law(0.005, 0, -0.002).force;
    EXPECT_NEAR(force.x / force.z, 0.005 / (axis - 0.002), 1e-15);
}

TEST(Contact, MagnitudeIsContinuousOverFacetsForVerticalDepthOnly) {
    for (const DepthReading depth : {DepthReading::vertical, DepthReading::normal}) {
        Scene scene = bump(kRadii[0], 4);
        scene.force.depth = depth;
        const OwnedLaw<double> law(scene);
        const double vertex = law.tables.facet_vertices[3];
        const double jump =
            magnitude(law(vertex, 0, -0.001).force) - magnitude(law(std::nextafter(vertex, 0.0), 0, -0.001).force);
        if (depth == DepthReading::vertical)
            EXPECT_LT(std::abs(jump), 1e-12);
        else
            EXPECT_GT(std::abs(jump), 0.1);
    }
}

TEST(Contact, ProxyLiesOnTheSurfaceAndExplainsTheForce) {
    for (Scene scene : many_bumps()) {
        scene.force.shading = Shading::none;
        const OwnedLaw<double> law(scene);
        at_random_points([&](double x, double y, double z) {
            const auto contact = law(x, y, z);
            const double length = norm(contact.proxy.x - x, contact.proxy.y - y, contact.proxy.z - z);
            EXPECT_NEAR(length, contact.depth, 1e-17 + 1e-14 * length);
            EXPECT_NEAR(magnitude(contact.force), 1000 * contact.depth, 1e-12);
        });
    }
}

TEST(Contact, CylinderBumpIsTheSumOfItsParts) {
    const OwnedLaw<double> law(cylinder_bump(kRadii[0]));
    const double axis = std::sqrt((kRadii[0] - kHalfWidth) * (kRadii[0] + kHalfWidth));
    at_random_points([&](double x, double y, double z) {
        const double distance = std::hypot(x, z + axis), inside = std::max(0.0, kRadii[0] - distance);
        const auto force = law(x, y, z).force;
        EXPECT_NEAR(force.x, 1000 * inside * x / distance, 1e-11);
        EXPECT_NEAR(force.z, 1000 * (std::max(0.0, -z) + inside * (z + axis) / distance), 1e-11);
    });
}

TEST(Contact, TexturePullsDownhill) {
    Scene scene = bump(kRadii[0], 2, Shading::reference);
    TextureSpec texture;
    texture.stiffness = 300;
    texture.map.function = MapFunction::gaussian;
    texture.map.radius = 0.004;
    texture.map.height = 0.001;
    const OwnedLaw<double> plain(scene);
    scene.texture = texture;
    const OwnedLaw<double> textured(scene);
    const auto u = [](double x, double y) { return 0.001 * std::exp(-(x * x + y * y) / (0.004 * 0.004)); };
    at_random_points([&](double x, double y, double z) {
        const auto before = plain(x, y, z), after = textured(x, y, z);
        const double step = 1e-7;
        EXPECT_NEAR(after.force.x - before.force.x,
                    -300 * before.depth * (u(x + step, y) - u(x - step, y)) / (2 * step), 1e-7);
        EXPECT_NEAR(after.force.y - before.force.y,
                    -300 * before.depth * (u(x, y + step) - u(x, y - step)) / (2 * step), 1e-7);
        EXPECT_EQ(after.force.z, before.force.z);
    });
}

} // namespace
} // namespace forceshade::test
