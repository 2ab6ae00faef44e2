// L6 with probes far off: no wall is passed on the way, and what of the way is along the surface is kept.
#include <limits>
#include <memory>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/reference/god_object.h"
#include "tests/mesh/god_object_referee.h"
#include "tests/mesh/god_object_walks.h"

namespace forceshade {
namespace {

using glm::dvec3;

/// A floor of two facets and, on its right half, a wall across it; leaning over by `turn`.
PolygonSoup room(double turn) {
    PolygonSoup soup;
    soup.vertices = {{-1, -1, 0},  {1, -1, 0},  {1, 1, 0},     {-1, 1, 0},
                     {0.5, -1, 0}, {0.5, 1, 0}, {0.5, 1, 0.5}, {0.5, -1, 0.5}};
    shapes::add_facet(soup, {0, 1, 2, 3});
    shapes::add_facet(soup, {4, 5, 6, 7});
    for (dvec3& v : soup.vertices)
        v = {std::cos(turn) * v.x - std::sin(turn) * v.z, v.y, std::sin(turn) * v.x + std::cos(turn) * v.z};
    return soup;
}

template <typename T> struct Room {
    explicit Room(double turn)
        : sine(std::sin(turn)), cosine(std::cos(turn)), structure(build_structure(shapes::mesh_of(room(turn)))),
          tables(make_mesh_tables<T>(structure, 1.0)), mesh(tables.view()),
          triangles(brute::Triangles::of(mesh.vertices, mesh.triangle_corners)) {}

    /// Takes the probe there, in the room's own directions, and looks whether the way passes something.
    void go(const dvec3& in_room) {
        const dvec3 world(cosine * in_room.x - sine * in_room.z, in_room.y, sine * in_room.x + cosine * in_room.z);
        const auto trace = [&](const glm::vec<3, T>& from, const glm::vec<3, T>& to) {
            for (const auto& corners : triangles.corners)
                EXPECT_FALSE(brute::segment_touches_triangle(dvec3(from), dvec3(to), corners));
        };
        contact = reference::update(mesh, state, *around, glm::vec<3, T>(to_mesh_frame(structure, world)), trace);
        EXPECT_TRUE(contact.finished);
    }
    dvec3 proxy() const {
        const dvec3 world = dvec3(contact.proxy) * structure.scale + structure.centre;
        return {cosine * world.x + sine * world.z, world.y, cosine * world.z - sine * world.x};
    }

    double sine, cosine;
    MeshStructure structure;
    MeshTables<T> tables;
    layout::MeshView<T> mesh;
    brute::Triangles triangles;
    reference::GodObject<T> state;
    std::unique_ptr<reference::Neighbourhood<T>> around = std::make_unique<reference::Neighbourhood<T>>();
    reference::GodObjectContact<T> contact{};
};

template <typename T> class GodObjectFar : public testing::Test {
protected:
    static constexpr bool kDouble = std::is_same_v<T, double>;
    static constexpr double kSkin = double(reference::Skin<T>::kWidth);
    static constexpr int kMostPower = kDouble ? 48 : 20;
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(GodObjectFar, Precisions);

TYPED_TEST(GodObjectFar, AWallStops) {
    for (int power = 0; power <= this->kMostPower; ++power) {
        Room<TypeParam> upright(0);
        upright.go({0.1, -0.3, 0.5});
        upright.go({0.1, -0.3, -0.5});
        for (const char* time : {"once", "again"}) {
            upright.go({0.7, 0.6, -std::ldexp(1.0, power)});
            EXPECT_NEAR(upright.proxy().x, 0.5, 2 * this->kSkin) << power << ' ' << time;
            EXPECT_NEAR(upright.proxy().y, 0.6, 2 * this->kSkin + 1e-6) << power << ' ' << time;
            EXPECT_NEAR(upright.proxy().z, 0, 2 * this->kSkin) << power << ' ' << time;
        }
    }
}

TYPED_TEST(GodObjectFar, ALeaningRoomAsWellAsTheProbeIsKnown) {
    for (int power = 0; power <= this->kMostPower; ++power) {
        const double depth = std::ldexp(1.0, power);
        const double rounding = 4 * depth * double(std::numeric_limits<TypeParam>::epsilon());
        Room<TypeParam> leaning(0.3);
        leaning.go({0.1, -0.3, 0.5});
        leaning.go({0.1, -0.3, -0.5});
        for (const char* time : {"once", "again"}) {
            leaning.go({0.7 + 2 * rounding, 0.6, -depth});
            EXPECT_NEAR(leaning.proxy().x, 0.5, 3 * this->kSkin + 1e-6) << power << ' ' << time;
            EXPECT_NEAR(leaning.proxy().y, 0.6, 2 * this->kSkin + 1e-6) << power << ' ' << time;
            leaning.go({0.2, 0.1, -depth});
            EXPECT_NEAR(leaning.proxy().x, 0.2, 2 * this->kSkin + rounding + 1e-6) << power << ' ' << time;
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
    const MeshStructure structure =
        build_structure(shapes::mesh_of(shapes::patch(shapes::Cells::triangles, 100, flat)));
    const MeshTables<TypeParam> tables = make_mesh_tables<TypeParam>(structure, 1.0);
    const layout::MeshView<TypeParam> mesh = tables.view();
    auto around = std::make_unique<reference::Neighbourhood<TypeParam>>();
    for (const int power : {1, 10, this->kMostPower}) {
        reference::GodObject<TypeParam> state;
        const TypeParam depth = std::ldexp(TypeParam(1), power);
        reference::update(mesh, state, *around, {TypeParam(-0.4), TypeParam(-0.3), TypeParam(0.1)});
        reference::update(mesh, state, *around, {TypeParam(-0.4), TypeParam(-0.3), -depth});
        const auto contact = reference::update(mesh, state, *around, {TypeParam(0.375), TypeParam(0.25), -depth});
        EXPECT_NEAR(double(contact.proxy.x), 0.375, 2 * this->kSkin) << power;
        EXPECT_NEAR(double(contact.proxy.y), 0.25, 2 * this->kSkin) << power;
    }
}

} // namespace
} // namespace forceshade
