// L6 on shapes whose answer is known: edges, corners, plates, symmetry, bad numbers, degenerate meshes.
#include <limits>

#include <gtest/gtest.h>

#include "tests/mesh/god_object_run.h"

namespace forceshade {
namespace {

using glm::dvec3;

/// A god-object on a mesh, spoken to in metres.
template <typename T> struct Touchpad : walks::Run<T> {
    using walks::Run<T>::Run;

    reference::GodObjectContact<T> at(const dvec3& world) {
        probe = glm::vec<3, T>(to_mesh_frame(this->structure, world));
        contact = this->update(probe);
        EXPECT_TRUE(contact.finished);
        return contact;
    }
    dvec3 proxy() const { return dvec3(contact.proxy) * this->structure.scale + this->structure.centre; }

    glm::vec<3, T> probe{0};
    reference::GodObjectContact<T> contact{};
};

void expect_near(const dvec3& a, const dvec3& b, double tolerance) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

template <typename T> class GodObjectShape : public ::testing::Test {
protected:
    static constexpr double kTolerance = std::is_same_v<T, double> ? 1e-14 : 1e-6;
};
using Precisions = ::testing::Types<float, double>;
TYPED_TEST_SUITE(GodObjectShape, Precisions);

TYPED_TEST(GodObjectShape, OverAConvexEdgeWithinOneUpdate) {
    Touchpad<TypeParam> pad(shapes::cube(true));
    pad.at({0.9, 0, 1.2});
    pad.at({0.9, 0, 0.8});
    expect_near(pad.proxy(), {0.9, 0, 1}, this->kTolerance);
    // Further along than the top goes: over the edge and down to the probe's height.
    pad.at({1.1, 0, 0.5});
    EXPECT_FALSE(pad.contact.touching);
    EXPECT_EQ(pad.contact.proxy, pad.probe);
    pad.at({0.9, 0.1, 0.5});
    expect_near(pad.proxy(), {1, 0.1, 0.5}, this->kTolerance);
}

TYPED_TEST(GodObjectShape, IntoACornerOfThreePlanesWithinOneUpdate) {
    Touchpad<TypeParam> pad(shapes::cube());
    pad.at({0, 0.1, 0.2});
    EXPECT_FALSE(pad.contact.touching);
    pad.at({1.5, 0.1, 0.2});
    expect_near(pad.proxy(), {1, 0.1, 0.2}, this->kTolerance);
    pad.at({1.5, 1.25, 0.3});
    expect_near(pad.proxy(), {1, 1, 0.3}, this->kTolerance);
    EXPECT_EQ(pad.contact.count, 2u);
    pad.at({1.25, 1.5, -1.125});
    expect_near(pad.proxy(), {1, 1, -1}, this->kTolerance);
    EXPECT_EQ(pad.contact.count, 3u);
    EXPECT_LT(pad.contact.facets[0], pad.contact.facets[1]);
    EXPECT_LT(pad.contact.facets[1], pad.contact.facets[2]);
}

TYPED_TEST(GodObjectShape, KeepsItsSideOfAThinPlate) {
    for (const double thickness : {5e-4, 2e-3}) {
        Touchpad<TypeParam> pad(shapes::plate(thickness));
        pad.at({0.1, 0.2, 0.3});
        // Far beyond the other face, and along to near the rim.
        for (const double depth : {1e-4, 1e-3, 0.01, 0.4}) {
            pad.at({0.1, 0.2, -depth});
            EXPECT_EQ(pad.contact.count, 1u);
            EXPECT_GT(pad.contact.normals[0].z, 0);
            expect_near(pad.proxy(), {0.1, 0.2, pad.proxy().z}, this->kTolerance);
            EXPECT_GE(pad.proxy().z, -1e-6);
        }
    }
}

TYPED_TEST(GodObjectShape, ApexAndRidgeGoToTheLowestFacet) {
    // A pyramid pressed straight down on its apex: facets 0 to 3 are alike.
    Touchpad<TypeParam> pad(shapes::soup_of({{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 0, 1}},
                                            {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}, {3, 2, 1, 0}}));
    pad.at({0, 0, 1.5});
    pad.at({0, 0, 0.5});
    ASSERT_EQ(pad.contact.count, 1u);
    EXPECT_EQ(pad.contact.facets[0], 0u);
    expect_near(pad.proxy(), {0, 0.25, 0.75}, this->kTolerance);

    Touchpad<TypeParam> ridge(walks::wedge(1.0));
    ridge.at({0, 0.125, 0.5});
    ridge.at({0, 0.125, -0.25});
    ASSERT_EQ(ridge.contact.count, 1u);
    EXPECT_EQ(ridge.contact.facets[0], 0u);
}

TYPED_TEST(GodObjectShape, TheTriangulationOfAFacetDoesNotShow) {
    Touchpad<TypeParam> whole(shapes::cube(false)), cut(shapes::cube(true));
    for (int i = 0; i < 400; ++i) {
        const dvec3 world(0.9 * std::sin(0.03 * i), 0.9 * std::sin(0.041 * i), i == 0 ? 1.5 : 0.95);
        whole.at(world);
        cut.at(world);
        expect_near(whole.proxy(), cut.proxy(), this->kTolerance);
        if (i > 0) {
            expect_near(whole.proxy(), {world.x, world.y, 1}, this->kTolerance);
        }
    }
}

TYPED_TEST(GodObjectShape, NumbersThatAreNoneChangeNothing) {
    Touchpad<TypeParam> pad(shapes::cube());
    pad.at({0, 0, 1.5});
    pad.at({0, 0, 0.5});
    const auto proxy = pad.state.proxy;
    const TypeParam nan = std::numeric_limits<TypeParam>::quiet_NaN();
    const TypeParam infinity = std::numeric_limits<TypeParam>::infinity();
    for (const glm::vec<3, TypeParam> bad : {glm::vec<3, TypeParam>(nan, 0, 0), glm::vec<3, TypeParam>(0, infinity, 0),
                                             glm::vec<3, TypeParam>(0, 0, -infinity)}) {
        const auto contact = reference::update(pad.mesh, pad.state, *pad.around, bad);
        EXPECT_FALSE(contact.touching);
        EXPECT_EQ(contact.count, 0u);
        EXPECT_EQ(pad.state.proxy, proxy);
    }
    pad.at({0, 0, 0.75});
    expect_near(pad.proxy(), {0, 0, 1}, this->kTolerance);
}

TYPED_TEST(GodObjectShape, FarAwayAndBack) {
    Touchpad<TypeParam> pad(shapes::cube());
    const double far = std::is_same_v<TypeParam, double> ? 1e300 : 1e30;
    for (const double size : {3.0, 1e3, 1e7, far}) {
        pad.state = {};
        pad.at({0.1, 0.2, size});
        EXPECT_FALSE(pad.contact.touching);
        pad.at({0.1, 0.2, 0.5});
        // From far off the direction is no better than its rounding.
        if (size < 1e6) {
            ASSERT_TRUE(pad.contact.touching);
            EXPECT_NEAR(pad.proxy().z, 1, 1e-6);
        }
        pad.at({0.1, 0.2, -size});
        pad.at({0.1, 0.2, size});
        EXPECT_FALSE(pad.contact.touching);
    }
}

TYPED_TEST(GodObjectShape, BeginsOnTheSideWhereItIs) {
    for (const double side : {1.0, -1.0, 0.0}) {
        Touchpad<TypeParam> pad(shapes::cube());
        const double off = side * 0.25 * double(reference::Skin<TypeParam>::kWidth);
        pad.at({0.1, 0.2, 1 + off});
        pad.at({0.1, 0.2, 1 - 0.25});
        EXPECT_EQ(pad.contact.touching, side >= 0) << side;
        pad.at({0.1, 0.2, 1 + 0.25});
        EXPECT_EQ(pad.contact.touching, side < 0) << side;
    }
}

TYPED_TEST(GodObjectShape, WhatWasNearBeforeDoesNotMatter) {
    static_assert(std::is_trivially_copyable_v<reference::GodObject<TypeParam>>);
    for (const walks::Terrain& terrain : walks::terrains()) {
        Touchpad<TypeParam> pad(terrain.polygons);
        walks::Wanderer wanderer(pad.structure, 17);
        reference::GodObject<TypeParam> other;
        dvec3 at = wanderer.begin();
        for (int i = 0; i < 2000; ++i) {
            at = wanderer.step(at);
            const glm::vec<3, TypeParam> probe(at);
            const auto contact = reference::update(pad.mesh, pad.state, *pad.around, probe);
            const auto fresh = std::make_unique<reference::Neighbourhood<TypeParam>>();
            const auto again = reference::update(pad.mesh, other, *fresh, probe);
            ASSERT_EQ(contact.proxy, again.proxy) << terrain.name << ' ' << i;
            ASSERT_EQ(pad.state.proxy, other.proxy) << terrain.name << ' ' << i;
            ASSERT_EQ(contact.count, again.count) << terrain.name << ' ' << i;
        }
    }
}

// No ripple: along a row of edges exactly, and across them all.
TEST(GodObjectForce, OfAPlaneOfManyTrianglesIsThatOfAPlane) {
    for (const double slant : {0.0, 0.31}) {
        Touchpad<double> pad(shapes::patch(shapes::Cells::triangles, 40, [](double x, double) { return 0.25 * x; }));
        pad.at({-0.45, -0.2, 2});
        const auto force_at = [&](double share) {
            pad.at(dvec3(-0.45, -0.2, -0.15) + share * dvec3(0.9, slant, 0.225));
            return pad.contact.proxy - pad.probe;
        };
        const dvec3 first = force_at(0);
        for (int i = 1; i <= 7000; ++i)
            ASSERT_LE(glm::length(force_at(i / 7000.0) - first), 1e-15) << i;
    }
}

TEST(GodObjectForce, ShadedFromBothSides) {
    Touchpad<double> pad(shapes::cube());
    layout::Law<double> law{};
    law.features.surface = layout::kSurfaceMesh;
    law.features.shading = layout::kShadingMeanValue;
    law.mesh = pad.mesh;
    for (const double from : {1.5, 0.0}) {
        pad.state = {};
        pad.at({0.25, 0.5, from});
        const double side = from > 1 ? 1 : -1;
        pad.at({0.25, 0.5, 1 - side * 0.25});
        const auto contact = reference::mesh_contact(law, pad.contact, pad.probe);
        EXPECT_NEAR(contact.depth, 0.25, 1e-15);
        EXPECT_NEAR(contact.unshaded.z, side * 0.25, 1e-15);
        EXPECT_NEAR(glm::length(contact.force), 0.25, 1e-15);
        EXPECT_GT(side * contact.force.z, 0);
        // The vertex normals of a cube lean outwards.
        EXPECT_GT(side * contact.force.x, 0.01);
    }
    const auto free = reference::mesh_contact(law, pad.at({0, 0, 0}), pad.probe);
    EXPECT_EQ(free.force, glm::dvec3(0));
    EXPECT_EQ(free.facet, layout::kNoFacet);
}

/// A floor of two facets and, on its right half, a wall across it; leaning over by `turn`.
PolygonSoup room(double turn) {
    PolygonSoup soup = shapes::soup_of(
        {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0.5, -1, 0}, {0.5, 1, 0}, {0.5, 1, 0.5}, {0.5, -1, 0.5}},
        {{0, 1, 2, 3}, {4, 5, 6, 7}});
    for (dvec3& v : soup.vertices)
        v = {std::cos(turn) * v.x - std::sin(turn) * v.z, v.y, std::sin(turn) * v.x + std::cos(turn) * v.z};
    return soup;
}

template <typename T> struct Room : walks::Run<T> {
    explicit Room(double turn) : walks::Run<T>(room(turn)), sine(std::sin(turn)), cosine(std::cos(turn)) {}

    /// Takes the probe there, in the room's own directions, and looks whether the way passes something.
    void go(const dvec3& in_room) {
        const dvec3 world(cosine * in_room.x - sine * in_room.z, in_room.y, sine * in_room.x + cosine * in_room.z);
        contact = this->update(glm::vec<3, T>(to_mesh_frame(this->structure, world)));
        EXPECT_TRUE(contact.finished && !this->crossed);
    }
    dvec3 proxy() const {
        const dvec3 world = dvec3(contact.proxy) * this->structure.scale + this->structure.centre;
        return {cosine * world.x + sine * world.z, world.y, cosine * world.z - sine * world.x};
    }

    double sine, cosine;
    reference::GodObjectContact<T> contact{};
};

template <typename T> class GodObjectFar : public ::testing::Test {
protected:
    static constexpr bool kDouble = std::is_same_v<T, double>;
    static constexpr double kSkin = double(reference::Skin<T>::kWidth);
    static constexpr int kMostPower = kDouble ? 48 : 20;
};
TYPED_TEST_SUITE(GodObjectFar, Precisions);

TYPED_TEST(GodObjectFar, AWallStopsAsWellAsTheProbeIsKnown) {
    for (const double turn : {0.0, 0.3})
        for (int power = 0; power <= this->kMostPower; ++power) {
            const double depth = std::ldexp(1.0, power), crumb = turn > 0 ? 1e-6 : 0;
            const double rounding = turn > 0 ? 4 * depth * double(std::numeric_limits<TypeParam>::epsilon()) : 0;
            Room<TypeParam> room(turn);
            room.go({0.1, -0.3, 0.5});
            room.go({0.1, -0.3, -0.5});
            for (const char* time : {"once", "again"}) {
                room.go({0.7 + 2 * rounding, 0.6, -depth});
                EXPECT_NEAR(room.proxy().x, 0.5, (turn > 0 ? 3 : 2) * this->kSkin + crumb) << power << ' ' << time;
                EXPECT_NEAR(room.proxy().y, 0.6, 2 * this->kSkin + 1e-6) << power << ' ' << time;
                EXPECT_NEAR(room.proxy().z, 0, 2 * this->kSkin + rounding + crumb) << power << ' ' << time;
                room.go({0.2, 0.1, -depth});
                EXPECT_NEAR(room.proxy().x, 0.2, 2 * this->kSkin + rounding + 1e-6) << power << ' ' << time;
            }
        }
}

TYPED_TEST(GodObjectFar, FromOneSideToTheOther) {
    for (int power = 1; power <= (this->kDouble ? 48 : 40); ++power) {
        const double far = std::ldexp(1.0, power);
        for (const double side : {1.0, -1.0}) {
            Room<TypeParam> upright(0);
            upright.go({0.1, -0.3, side * far});
            EXPECT_FALSE(upright.contact.touching) << power;
            upright.go({0.1, -0.3, -side * far});
            EXPECT_TRUE(upright.contact.touching) << power << ' ' << side;
            EXPECT_NEAR(upright.proxy().x, 0.1, 2 * this->kSkin + 1e-6) << power << ' ' << side;
            EXPECT_NEAR(upright.proxy().y, -0.3, 2 * this->kSkin + 1e-6) << power << ' ' << side;
        }
        // Past it.
        Room<TypeParam> upright(0);
        upright.go({5, 0, far});
        upright.go({5, 0, -far});
        EXPECT_FALSE(upright.contact.touching) << power;
    }
}

TYPED_TEST(GodObjectFar, OverManyFacets) {
    const auto flat = [](double, double) { return 0.0; };
    walks::Run<TypeParam> run(shapes::patch(shapes::Cells::triangles, 100, flat));
    for (const int power : {1, 10, this->kMostPower}) {
        run.state = {};
        const TypeParam depth = std::ldexp(TypeParam(1), power);
        run.update({TypeParam(-0.4), TypeParam(-0.3), TypeParam(0.1)});
        run.update({TypeParam(-0.4), TypeParam(-0.3), -depth});
        const auto contact = run.update({TypeParam(0.375), TypeParam(0.25), -depth});
        EXPECT_NEAR(double(contact.proxy.x), 0.375, 2 * this->kSkin) << power;
        EXPECT_NEAR(double(contact.proxy.y), 0.25, 2 * this->kSkin) << power;
    }
}

} // namespace
} // namespace forceshade
