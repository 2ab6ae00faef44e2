// L6 on shapes whose answer is known: edges, corners, plates, symmetry, bad numbers, degenerate meshes.
#include <limits>
#include <memory>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

using glm::dvec3;

/// A god-object on a mesh, spoken to in metres.
template <typename T> struct Touchpad {
    explicit Touchpad(PolygonSoup polygons)
        : structure(build_structure(shapes::mesh_of(std::move(polygons)))), tables(make_mesh_tables<T>(structure, 1.0)),
          mesh(tables.view()) {}

    reference::GodObjectContact<T> at(const dvec3& world) {
        probe = glm::vec<3, T>(to_mesh_frame(structure, world));
        contact = reference::update(mesh, state, *around, probe);
        EXPECT_TRUE(contact.finished);
        return contact;
    }
    dvec3 proxy() const { return dvec3(contact.proxy) * structure.scale + structure.centre; }

    MeshStructure structure;
    MeshTables<T> tables;
    layout::MeshView<T> mesh;
    reference::GodObject<T> state;
    std::unique_ptr<reference::Neighbourhood<T>> around = std::make_unique<reference::Neighbourhood<T>>();
    glm::vec<3, T> probe{0};
    reference::GodObjectContact<T> contact{};
};

void expect_near(const dvec3& a, const dvec3& b, double tolerance) {
    EXPECT_LE(glm::length(a - b), tolerance)
        << a.x << ' ' << a.y << ' ' << a.z << " against " << b.x << ' ' << b.y << ' ' << b.z;
}

template <typename T> class GodObjectShape : public testing::Test {
protected:
    static constexpr double kTolerance = std::is_same_v<T, double> ? 1e-14 : 1e-6;
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GodObjectShape, Precisions);

TYPED_TEST(GodObjectShape, FreeUntilItTouches) {
    Touchpad<TypeParam> pad(shapes::cube(true));
    EXPECT_FALSE(pad.at({0.2, 0.3, 1.5}).touching);
    EXPECT_EQ(pad.contact.proxy, pad.probe);
    EXPECT_TRUE(pad.at({0.25, 0.3, 0.9}).touching);
    expect_near(pad.proxy(), {0.25, 0.3, 1.0}, this->kTolerance);
    EXPECT_EQ(pad.contact.count, 1u);
    EXPECT_FALSE(pad.at({0.25, 0.3, 1.1}).touching);
    EXPECT_EQ(pad.contact.proxy, pad.probe);
}

TYPED_TEST(GodObjectShape, OverAConvexEdgeWithinOneUpdate) {
    Touchpad<TypeParam> pad(shapes::cube(true));
    pad.at({0.9, 0, 1.2});
    pad.at({0.9, 0, 0.8});
    expect_near(pad.proxy(), {0.9, 0, 1}, this->kTolerance);
    // Further along than the top goes: over the edge and down to the probe's height.
    pad.at({1.1, 0, 0.5});
    EXPECT_FALSE(pad.contact.touching);
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
    PolygonSoup pyramid;
    pyramid.vertices = {{1, 1, 0}, {-1, 1, 0}, {-1, -1, 0}, {1, -1, 0}, {0, 0, 1}};
    shapes::add_facet(pyramid, {0, 1, 4});
    shapes::add_facet(pyramid, {1, 2, 4});
    shapes::add_facet(pyramid, {2, 3, 4});
    shapes::add_facet(pyramid, {3, 0, 4});
    shapes::add_facet(pyramid, {3, 2, 1, 0});
    Touchpad<TypeParam> pad(pyramid);
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

TYPED_TEST(GodObjectShape, OpenDuplicateNeedleAndSliverMeshes) {
    PolygonSoup twice = shapes::single_triangle();
    twice = shapes::merged(twice, twice);
    for (PolygonSoup soup : {shapes::single_triangle(), twice, shapes::needle_fan(1000, 1.0),
                             shapes::sliver_box(64, 1e8), shapes::many_gon_prism(300)}) {
        Touchpad<TypeParam> pad(soup);
        walks::Wanderer wanderer(pad.structure, 3);
        dvec3 at = wanderer.begin();
        for (int i = 0; i < 4000; ++i) {
            at = i % 200 == 0 ? wanderer.begin() : wanderer.step(at);
            if (i % 200 == 0)
                pad.state = {};
            const auto contact = reference::update(pad.mesh, pad.state, *pad.around, glm::vec<3, TypeParam>(at));
            ASSERT_TRUE(contact.finished) << i;
        }
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

} // namespace
} // namespace forceshade
