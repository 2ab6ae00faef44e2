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

TEST(Pieces, OneThatFacesInwardIsNamedUnlessItIsACavity) {
    const PolygonSoup apart = shapes::merged(box(0, 1, false), box(5, 1, true));
    ASSERT_EQ(inspect(apart).inside_out.size(), 1u);
    EXPECT_EQ(inspect(apart).inside_out[0], "piece 2 of 2 (6 facets, from facet 6 on)");
    const PolygonSoup hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    EXPECT_TRUE(inspect(hollow).inside_out.empty());
    // In the cavity an outward piece is a solid, an inward one is not.
    EXPECT_TRUE(inspect(shapes::merged(hollow, box(0, 0.5, false))).inside_out.empty());
    EXPECT_EQ(inspect(shapes::merged(hollow, box(0, 0.5, true))).inside_out.size(), 1u);
    ASSERT_EQ(inspect(box(0, 1, true)).inside_out.size(), 1u);
    EXPECT_EQ(inspect(box(0, 1, true)).inside_out[0], "the mesh");
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

TEST(Pieces, OneThatFacesOutwardWithinAnotherIsNamed) {
    const PolygonSoup nested = shapes::merged(box(0, 2, false), box(0, 1, false));
    ASSERT_EQ(inspect(nested).nested.size(), 1u);
    EXPECT_EQ(inspect(nested).nested[0], "piece 2 of 2 (6 facets, from facet 6 on)");
    const PolygonSoup hollow = shapes::merged(box(0, 2, false), box(0, 1, true));
    EXPECT_TRUE(inspect(hollow).nested.empty());
    EXPECT_TRUE(inspect(shapes::merged(hollow, box(0, 0.5, false))).nested.empty()); // a solid in the cavity
    EXPECT_TRUE(inspect(shapes::merged(box(0, 1, false), box(5, 1, false))).nested.empty());
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

std::size_t inward(const MeshMarks& marks) {
    return static_cast<std::size_t>(std::count(marks.inward.begin(), marks.inward.end(), true));
}

TEST(Marks, ACubeHasTwelveSharpEdgesAndNothingElse) {
    const MeshMarks marks = marks_of(shapes::cube());
    EXPECT_EQ(marks.sharp.size(), 12u); // and none across its faces, which are cut into triangles
    EXPECT_EQ(marks.rims.size() + marks.crowded.size() + marks.crossing.size() + inward(marks), 0u);
    for (const auto& [from, to] : marks.sharp)
        EXPECT_EQ(glm::distance(from, to), 2);
}

TEST(Marks, ASphereOfManyFacetsHasNoSharpEdge) {
    EXPECT_TRUE(marks_of(shapes::icosphere(1)).sharp.empty());
}

TEST(Marks, RimsOfAnOpenCube) {
    const MeshMarks marks = marks_of(shapes::open_cube());
    EXPECT_EQ(marks.rims.size(), 4u);
    EXPECT_EQ(marks.sharp.size(), 8u);
}

TEST(Marks, EdgesOfThreeFacets) {
    const MeshMarks marks = marks_of(
        shapes::soup_of({{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.2}, {0, 0, 1}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}}));
    EXPECT_EQ(marks.crowded.size(), 3u); // each triangle's own
    EXPECT_EQ(marks.rims.size(), 6u);
}

TEST(Marks, PiecesThatFaceInward) {
    const PolygonSoup pair =
        shapes::merged(shapes::cube(), shapes::reversed(shapes::moved(shapes::cube(), glm::dvec3(1), {5, 0, 0})));
    const MeshMarks marks = marks_of(pair);
    EXPECT_EQ(inward(marks), 6u);
    EXPECT_FALSE(marks.inward[0]);
    EXPECT_TRUE(marks.inward[6]);
    EXPECT_EQ(inward(marks_of(shapes::reversed(shapes::cube()))), 6u);
}

TEST(Marks, TrianglesOfCrossingPieces) {
    const PolygonSoup pair = shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {1, 1, 1}));
    const MeshMarks marks = marks_of(pair);
    EXPECT_EQ(marks.crossing.size(), 12u);
    EXPECT_TRUE(std::ranges::is_sorted(marks.crossing));
    EXPECT_TRUE(marks_of(shapes::merged(shapes::cube(), shapes::moved(shapes::cube(), glm::dvec3(1), {3, 0, 0})))
                    .crossing.empty());
}

} // namespace
} // namespace forceshade
