// Vertices at one place are one, in every format; and those near each other, where they are to be.
#include "host/mesh/places.h"

#include <algorithm>
#include <cmath>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "host/mesh/findings.h"
#include "host/mesh/mesh_file.h"
#include "host/mesh/structure.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"

namespace forceshade {
namespace {

PolygonSoup shuffled(PolygonSoup polygons, unsigned seed) {
    std::mt19937 random(seed);
    std::vector<std::uint32_t> order(polygons.vertices.size());
    for (std::uint32_t i = 0; i < order.size(); ++i)
        order[i] = i;
    std::shuffle(order.begin(), order.end(), random);
    const std::vector<glm::dvec3> vertices = polygons.vertices;
    for (std::uint32_t i = 0; i < order.size(); ++i)
        polygons.vertices[order[i]] = vertices[i];
    for (std::uint32_t& corner : polygons.corners)
        corner = order[corner];
    return polygons;
}

std::vector<PolygonSoup> wholes() {
    return {shapes::cube(), shapes::icosphere(2), shapes::random_polyhedra(5, 7), shapes::spot()};
}

std::vector<glm::dvec3> normals_of_corners(const PolygonSoup& polygons, VertexNormals weights) {
    const Mesh mesh = prepare_mesh(polygons, {}, weights);
    std::vector<glm::dvec3> normals;
    for (const std::uint32_t corner : mesh.polygons.corners)
        normals.push_back(mesh.vertex_normals[corner]);
    return normals;
}

TEST(Places, FilesThatSplitVerticesAreShadedAsWholeOnes) {
    for (const PolygonSoup& whole : wholes())
        for (const PolygonSoup& given : {shapes::split(whole), shuffled(shapes::split(whole), 3)}) {
            std::vector<PolygonFile> files{parse_polygons("a.obj", testing::as_obj(given)),
                                           parse_polygons("a.off", testing::as_off(given)),
                                           parse_polygons("a.ply", testing::as_ply_text(given))};
            for (const PolygonFile& file : files) {
                EXPECT_EQ(file.polygons.vertices.size() + file.joined_vertices, given.vertices.size());
                const MeshFindings found = inspect(file.polygons), expected = inspect(whole);
                EXPECT_EQ(static_cast<const ConnectivityCounts&>(found), expected);
                EXPECT_EQ(is_solid(found), is_solid(expected));
                for (const VertexNormals weights : {VertexNormals::plain, VertexNormals::angle})
                    EXPECT_TRUE(normals_of_corners(file.polygons, weights) == normals_of_corners(whole, weights));
                const MeshStructure one = build_structure(shapes::mesh_of(file.polygons)),
                                    other = build_structure(shapes::mesh_of(whole));
                EXPECT_TRUE(one.reals->vertices == other.reals->vertices);
                EXPECT_TRUE(one.reals->vertex_normals == other.reals->vertex_normals);
                EXPECT_TRUE(one.reals->vertex_pseudonormals == other.reals->vertex_pseudonormals);
            }
        }
}

TEST(Places, JoiningDoesNotDependOnTheOrder) {
    PolygonSoup chain;
    for (int i = 0; i < 40; ++i)
        chain.vertices.emplace_back(0.9 * i, 5 * (i % 2), 0.1 * i); // two chains
    for (std::uint32_t i = 0; i + 2 < 40; ++i)
        shapes::add_facet(chain, {i, i + 1, i + 2});
    const double link = glm::length(chain.vertices[2] - chain.vertices[0]);
    for (const double distance : {0.5 * link, 1.001 * link, 3 * link}) {
        PolygonSoup one = chain, other = shuffled(chain, 9);
        join_vertices(one, distance);
        join_vertices(other, distance);
        const auto sorted = [](const PolygonSoup& polygons) {
            std::vector<std::array<double, 3>> places;
            for (const glm::dvec3& v : polygons.vertices)
                places.push_back({v.x, v.y, v.z});
            std::ranges::sort(places);
            return places;
        };
        EXPECT_EQ(sorted(one), sorted(other)) << distance;
        EXPECT_EQ(one.vertices.size(), distance < link ? 40u : distance < 2 * link ? 2u : 1u) << distance;
    }
}

TEST(Places, JoiningFindsEveryNearPair) {
    std::mt19937 random(4);
    PolygonSoup points;
    for (int i = 0; i < 400; ++i)
        points.vertices.emplace_back(shapes::uniform(random), shapes::uniform(random), shapes::uniform(random));
    for (std::size_t i = 0; i < 40; ++i) // hardly apart
        points.vertices[10 * i + 1] = points.vertices[10 * i] + shapes::anywhere(random, 1e-12);
    for (const double distance : {1e-12, 0.01, 0.05, 0.1, 0.2}) {
        const std::vector<std::uint32_t> places = weld_within(points, distance);
        DisjointSets expected(400);
        for (std::uint32_t i = 0; i < 400; ++i)
            for (std::uint32_t j = 0; j < i; ++j)
                if (glm::length(points.vertices[i] - points.vertices[j]) <= distance)
                    expected.join(i, j);
        for (std::uint32_t i = 0; i < 400; ++i)
            EXPECT_EQ(places[i], expected.find(i));
    }
}

TEST(Places, AFacetLosesCornersThatComeTogether) {
    PolygonSoup house = shapes::soup_of( // a roof of five corners, two of them near each other
        {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0.5, 1.5, 0}, {0.501, 1.5, 0}, {0.501, 1.501, 0}},
        {{0, 1, 2, 4, 3}, {3, 4, 5}});
    const JoinedVertices joined = join_vertices(house, 0.002);
    EXPECT_EQ(joined.vertices, 2u);
    EXPECT_EQ(joined.facets, 1u);
    EXPECT_EQ(house.corners_of(0), 4u);
    EXPECT_EQ(house.facets(), 2u);
    EXPECT_EQ(inspect(house).degenerate_facets, 1u);
}

TEST(Places, TheLeastDistanceThatClosesIsExact) {
    PolygonSoup crack = shapes::cube(true);
    EXPECT_FALSE(closing_distance(crack));
    const std::uint32_t corner = crack.outline(3)[1];
    crack.vertices.push_back(crack.vertices[corner] + glm::dvec3(3e-6, -4e-6, 0));
    crack.corners[crack.begins[3] + 1] = 8;
    ASSERT_TRUE(closing_distance(crack));
    EXPECT_NEAR(*closing_distance(crack), 5e-6, 1e-15);
    EXPECT_FALSE(inspect(crack).closed);
    PolygonSoup joined = crack;
    join_vertices(joined, *closing_distance(crack) * (1 + 1e-9));
    EXPECT_TRUE(inspect(joined).closed);
    joined = crack;
    join_vertices(joined, *closing_distance(crack) * (1 - 1e-9));
    EXPECT_FALSE(inspect(joined).closed);
    EXPECT_FALSE(closing_distance(shapes::open_cube())); // a hole, no crack
}

} // namespace
} // namespace forceshade
