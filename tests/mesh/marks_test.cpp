// What a picture of a mesh marks: its holes, edges of many facets, sharp edges, crossings and what faces inward.
#include "host/mesh/marks.h"

#include <algorithm>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

MeshMarks marks_of(const PolygonSoup& polygons) {
    const Mesh mesh = shapes::mesh_of(polygons);
    return find_marks(mesh, build_structure(mesh), inspect(polygons));
}

PolygonSoup moved(PolygonSoup soup, const glm::dvec3& by) {
    for (glm::dvec3& vertex : soup.vertices)
        vertex += by;
    return soup;
}

PolygonSoup turned(PolygonSoup soup) {
    for (std::size_t facet = 0; facet < soup.facets(); ++facet)
        std::reverse(soup.corners.begin() + soup.begins[facet], soup.corners.begin() + soup.begins[facet + 1]);
    return soup;
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
    PolygonSoup fan;
    fan.vertices = {{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {-1, 0, 0.2}, {0, 0, 1}};
    for (const std::uint32_t tip : {2U, 3U, 4U})
        shapes::add_facet(fan, {0, 1, tip});
    const MeshMarks marks = marks_of(fan);
    EXPECT_EQ(marks.crowded.size(), 3u); // each triangle's own
    EXPECT_EQ(marks.rims.size(), 6u);
}

TEST(Marks, PiecesThatFaceInward) {
    const PolygonSoup pair = shapes::merged(shapes::cube(), turned(moved(shapes::cube(), {5, 0, 0})));
    const MeshMarks marks = marks_of(pair);
    EXPECT_EQ(inward(marks), 6u);
    EXPECT_FALSE(marks.inward[0]);
    EXPECT_TRUE(marks.inward[6]);
    EXPECT_EQ(inward(marks_of(turned(shapes::cube()))), 6u);
}

TEST(Marks, TrianglesOfCrossingPieces) {
    const PolygonSoup pair = shapes::merged(shapes::cube(), moved(shapes::cube(), {1, 1, 1}));
    const MeshMarks marks = marks_of(pair);
    EXPECT_EQ(marks.crossing.size(), 12u);
    EXPECT_TRUE(std::ranges::is_sorted(marks.crossing));
    EXPECT_TRUE(marks_of(shapes::merged(shapes::cube(), moved(shapes::cube(), {3, 0, 0}))).crossing.empty());
}

} // namespace
} // namespace forceshade
