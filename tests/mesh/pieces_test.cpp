// The closed pieces of a mesh: which face inward, which are cavities, and turning them; and what a picture marks.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/connectivity.h"
#include "host/mesh/findings.h"
#include "host/mesh/structure.h"
#include "tests/io/folder.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using testing::says;

PolygonSoup box(double middle, double half, bool inward) {
    const PolygonSoup result = shapes::moved(shapes::cube(), glm::dvec3(half), {middle, 0, 0});
    return inward ? shapes::reversed(result) : result;
}

double volume(const PolygonSoup& polygons) {
    return inspect(polygons).volume;
}

TEST(Pieces, ThatFaceInwardOrOutwardWithinAnotherAreNamed) {
    using Names = std::vector<std::string>;
    struct Row {
        const char* what;
        PolygonSoup polygons;
        Names inside_out, nested;
    };
    const Names second{"piece 2 of 2 (6 facets, from facet 6 on)"}, third{"piece 3 of 3 (6 facets, from facet 12 on)"};
    const PolygonSoup solid = box(0, 1, false), hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    for (const auto& [what, polygons, inside_out, nested] :
         {Row{"the only piece inward", box(0, 1, true), {"the mesh"}, {}},
          {"two apart", shapes::merged(solid, box(5, 1, false)), {}, {}},
          {"two apart, one inward", shapes::merged(solid, box(5, 1, true)), second, {}},
          {"a cavity", hollow, {}, {}},
          {"a solid in the cavity", shapes::merged(hollow, box(0, 0.5, false)), {}, {}},
          {"an inward piece in the cavity", shapes::merged(hollow, box(0, 0.5, true)), third, {}},
          {"a solid in a solid", shapes::merged(box(0, 2, false), solid), {}, second}}) {
        EXPECT_EQ(inspect(polygons).inside_out, inside_out) << what;
        EXPECT_EQ(inspect(polygons).nested, nested) << what;
    }
}

TEST(Pieces, AreTurnedOutwardAndCavitiesStay) {
    PolygonSoup apart = shapes::merged(box(0, 1, false), box(5, 1, true));
    EXPECT_EQ(orient_outward(apart).size(), 1u);
    EXPECT_DOUBLE_EQ(volume(apart), 16);
    EXPECT_TRUE(orient_outward(apart).empty());
    PolygonSoup hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    EXPECT_TRUE(orient_outward(hollow).empty());
    EXPECT_DOUBLE_EQ(volume(hollow), 64 - 8);
}

TEST(Pieces, CavitiesOfWhatFacesInwardAreTurnedWithIt) {
    PolygonSoup inverted = shapes::merged(shapes::merged(box(0, 2, true), box(0, 1, false)), box(0, 0.5, true));
    EXPECT_EQ(orient_outward(inverted).size(), 3u);
    EXPECT_DOUBLE_EQ(volume(inverted), 64 - 8 + 1);
    EXPECT_TRUE(orient_outward(inverted).empty());
    EXPECT_TRUE(inspect(inverted).nested.empty() && inspect(inverted).inside_out.empty());
}

TEST(Pieces, FacetsAgainstTheOthersAreTurned) {
    const PolygonSoup sphere = shapes::icosphere(2);
    PolygonSoup mixed = sphere;
    for (std::size_t facet = 0; facet < mixed.facets(); facet += 3)
        std::reverse(&mixed.corners[mixed.begins[facet]], &mixed.corners[mixed.begins[facet + 1]]);
    const std::vector<std::string> turned = orient_outward(mixed);
    ASSERT_EQ(turned.size(), 1u);
    EXPECT_EQ(turned[0], "turned 107 facets of the mesh, which faced against the others");
    EXPECT_DOUBLE_EQ(volume(mixed), volume(sphere));
    EXPECT_EQ(inspect(mixed).misoriented_edges, 0u);
}

TEST(Pieces, AMoebiusStripHasNoOutside) {
    PolygonSoup strip;
    constexpr std::uint32_t kParts = 12;
    for (std::uint32_t i = 0; i < kParts; ++i) {
        const double angle = 2 * std::numbers::pi * i / kParts;
        for (const double side : {-0.3, 0.3}) {
            const double radius = 1 + side * std::cos(angle / 2);
            strip.vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), side * std::sin(angle / 2));
        }
    }
    for (std::uint32_t i = 0; i + 1 < kParts; ++i)
        shapes::add_facet(strip, {2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1});
    shapes::add_facet(strip, {2 * kParts - 2, 1, 0, 2 * kParts - 1});
    EXPECT_TRUE(find_pieces(strip).pieces[0].one_sided);
    EXPECT_TRUE(says(testing::message_of<UsageError>([&] { orient_outward(strip); }), "no outside"));
}

MeshMarks marks_of(const PolygonSoup& polygons) {
    const Mesh mesh = shapes::mesh_of(polygons);
    return find_marks(mesh, build_structure(mesh), inspect(polygons));
}

TEST(Marks, AreCountedByKind) {
    struct Row {
        const char* what;
        PolygonSoup polygons;
        std::size_t sharp, rims, crowded, inward, crossing;
    };
    const PolygonSoup cube = shapes::cube();
    const auto with_another = [&](const glm::dvec3& shift) {
        return shapes::merged(cube, shapes::moved(cube, glm::dvec3(1), shift));
    };
    const PolygonSoup fan =
        shapes::soup_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.2}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
    for (const auto& [what, polygons, sharp, rims, crowded, inward, crossing] :
         {Row{"a cube, no edge across its faces, which are cut into triangles", cube, 12, 0, 0, 0, 0},
          {"a sphere of many facets", shapes::icosphere(1), 0, 0, 0, 0, 0},
          {"a cube without its top", shapes::open_cube(), 8, 4, 0, 0, 0},
          {"three facets at an edge, which is crowded for each", fan, 0, 6, 3, 0, 0},
          {"a cube that faces inward", shapes::reversed(cube), 12, 0, 0, 6, 0},
          {"two cubes apart", with_another({3, 0, 0}), 24, 0, 0, 0, 0},
          {"two cubes that cross", with_another({1, 1, 1}), 24, 0, 0, 0, 12}}) {
        const MeshMarks marks = marks_of(polygons);
        EXPECT_EQ(marks.sharp.size(), sharp) << what;
        EXPECT_EQ(marks.rims.size(), rims) << what;
        EXPECT_EQ(marks.crowded.size(), crowded) << what;
        EXPECT_EQ(std::size_t(std::ranges::count(marks.inward, true)), inward) << what;
        EXPECT_EQ(marks.crossing.size(), crossing) << what;
        EXPECT_TRUE(std::ranges::is_sorted(marks.crossing)) << what;
    }
    for (const auto& [from, to] : marks_of(cube).sharp)
        EXPECT_EQ(glm::distance(from, to), 2);
}

TEST(Marks, TheFacetsOfThePieceThatFacesInwardAreMarked) {
    const MeshMarks marks = marks_of(shapes::merged(box(0, 1, false), box(5, 1, true)));
    EXPECT_FALSE(marks.inward[0]);
    EXPECT_TRUE(marks.inward[6]);
    EXPECT_EQ(std::ranges::count(marks.inward, true), 6);
}

} // namespace
} // namespace forceshade
