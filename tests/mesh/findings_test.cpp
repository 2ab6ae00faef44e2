// What inspection finds on meshes whose faults are known.
#include "host/mesh/findings.h"

#include <algorithm>
#include <array>
#include <random>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/connectivity.h"
#include "host/mesh/exact.h"
#include "host/mesh/mesh_file.h"
#include "host/mesh/places.h"
#include "tests/mesh/damage.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using shapes::add_facet;

PolygonSoup reversed(PolygonSoup soup, std::size_t facet) {
    std::reverse(soup.corners.begin() + soup.begins[facet], soup.corners.begin() + soup.begins[facet + 1]);
    return soup;
}

TEST(Findings, ACubeIsClosedAndFaultless) {
    const MeshFindings found = inspect(shapes::cube());
    EXPECT_EQ(found.vertices, 8u);
    EXPECT_EQ(found.quadrilaterals, 6u);
    EXPECT_EQ(found.triangles + found.others, 0u);
    EXPECT_EQ(found.most_corners, 4u);
    EXPECT_EQ(found.components, 1u);
    EXPECT_TRUE(found.closed);
    EXPECT_DOUBLE_EQ(found.volume, 8);
    EXPECT_DOUBLE_EQ(found.area, 24);
    EXPECT_EQ(found.low, glm::dvec3(-1));
    EXPECT_EQ(found.high, glm::dvec3(1));
    EXPECT_EQ(found.self_intersections, 0u);
    EXPECT_TRUE(faults(found).empty());
    EXPECT_NO_THROW(refuse_if_meaningless(found, "cube"));
}

TEST(Findings, FacetsTurnedInward) {
    const PolygonSoup cube = shapes::cube();
    const MeshFindings one = inspect(reversed(cube, 2));
    EXPECT_EQ(one.misoriented_edges, 4u);
    EXPECT_TRUE(one.closed);
    const MeshFindings all = inspect(shapes::reversed(cube));
    EXPECT_EQ(all.misoriented_edges, 0u);
    EXPECT_DOUBLE_EQ(all.volume, -8);
}

TEST(Findings, NonManifoldEdgeAndVertices) {
    const PolygonSoup fan =
        shapes::soup_of({{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-1, 1, 0}, {-1, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
    EXPECT_EQ(inspect(fan).non_manifold_edges, 1u);
    // Two tetrahedra that share a tip, closed fans both.
    const MeshFindings found = inspect(
        shapes::soup_of({{0, 0, 0}, {1, 0, 1}, {-1, 1, 1}, {-1, -1, 1}, {1, 0, -1}, {-1, 1, -1}, {-1, -1, -1}},
                        {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {3, 2, 1}, {0, 4, 5}, {0, 5, 6}, {0, 6, 4}, {6, 5, 4}}));
    EXPECT_EQ(found.non_manifold_vertices, 1u);
    EXPECT_EQ(found.components, 2u);
    EXPECT_TRUE(found.closed);
}

TEST(Findings, FacetsThatAreDegenerateDuplicateOrRepeatACorner) {
    PolygonSoup soup = shapes::cube(true);
    const std::uint32_t a = soup.corners[0], b = soup.corners[1], c = soup.corners[2];
    add_facet(soup, {b, c, a});
    add_facet(soup, {c, b, a});
    add_facet(soup, {a, b, a});
    soup.vertices.push_back(soup.vertices[a] + 3.0 * (soup.vertices[b] - soup.vertices[a]));
    add_facet(soup, {a, b, 8});
    soup.vertices.emplace_back(1e9, 0, 0);
    const MeshFindings found = inspect(soup);
    EXPECT_EQ(found.redundant_facets, 2u);
    EXPECT_EQ(found.opposed_facets, 0u);
    EXPECT_EQ(found.repeated_corner_facets, 1u);
    EXPECT_EQ(found.degenerate_facets, 2u);
    EXPECT_EQ(found.unused_vertices, 1u);
    EXPECT_LT(found.high.x, 10); // the unused vertex is not in the box
}

TEST(Findings, RedundantFacetsEnterNothing) {
    const MeshFindings sound = inspect(shapes::icosphere(1));
    std::mt19937 random(5);
    for (int trial = 0; trial < 20; ++trial) {
        MeshFindings found =
            inspect(shapes::damaged(shapes::icosphere(1), {.repeats = 10, .strays = 5, .shuffled = false}, random));
        EXPECT_EQ(found.redundant_facets, found.facets - sound.facets);
        EXPECT_EQ(faults(found, MeshUse::winding_field).size(), found.unused_vertices > 0 ? 2u : 1u);
        EXPECT_TRUE(found.closed);
        EXPECT_NEAR(found.volume, sound.volume, 1e-5);
        EXPECT_NEAR(found.area, sound.area, 1e-5);
        EXPECT_EQ(found.non_manifold_edges + found.boundary_edges, 0u);
        EXPECT_EQ(found.components, 1u);
    }
}

TEST(Findings, SheetsAndWallsAreToldOf) {
    PolygonSoup sheet = shapes::polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}});
    add_facet(sheet, {3, 2, 1, 0});
    const MeshFindings found = inspect(sheet);
    EXPECT_EQ(found.opposed_facets, 1u);
    EXPECT_EQ(found.redundant_facets, 0u);
    // Two cubes that share a face, each with its own.
    const PolygonSoup cube = shapes::cube();
    const MeshFindings cells = inspect(shapes::merged(cube, shapes::moved(cube, glm::dvec3(1), {2, 0, 0})));
    EXPECT_EQ(cells.opposed_facets, 1u);
    EXPECT_EQ(cells.redundant_facets, 0u);
}

TEST(Findings, SelfIntersections) {
    const PolygonSoup cube = shapes::cube(true);
    const MeshFindings apart = inspect(shapes::merged(cube, shapes::moved(cube, glm::dvec3(1), {3, 0, 0})));
    EXPECT_EQ(apart.self_intersections, 0u);
    EXPECT_EQ(apart.components, 2u);
    const PolygonSoup crossing = shapes::merged(cube, shapes::moved(cube, glm::dvec3(1), {0.51, 0.52, 0.53}));
    EXPECT_GT(inspect(crossing).self_intersections, 5u);
    EXPECT_FALSE(inspect(crossing, 3).self_intersections.has_value());
    EXPECT_EQ(inspect(shapes::nested_shells(2, true)).self_intersections, 0u);
}

// Through the tree, on any number of threads, as by looking at all pairs.
TEST(Findings, SelfIntersectionsAreThoseOfAllPairs) {
    std::size_t found = 0;
    for (unsigned seed = 1; seed <= 8; ++seed)
        for (const double size : {1.0, 1e-300, 1e300}) {
            const PolygonSoup soup =
                shapes::moved(shapes::random_polyhedra(10 * seed, seed), glm::dvec3(size), glm::dvec3(0));
            const MeshTriangles triangles = triangulate(soup, facet_normals(soup));
            const std::vector<std::uint32_t> places = weld(soup);
            const auto share_a_corner = [&](std::size_t i, std::size_t j) {
                for (const std::uint32_t one : triangles.corners[i])
                    for (const std::uint32_t other : triangles.corners[j])
                        if (places[one] == places[other])
                            return true;
                return false;
            };
            const auto corners = [&](std::size_t i) {
                const auto& [a, b, c] = triangles.corners[i];
                return std::array{soup.vertices[a], soup.vertices[b], soup.vertices[c]};
            };
            std::size_t expected = 0;
            for (std::size_t i = 0; i < triangles.corners.size(); ++i)
                for (std::size_t j = 0; j < i; ++j)
                    expected += !share_a_corner(i, j) && triangles_meet(corners(i), corners(j));
            for (const unsigned threads : {1u, 3u})
                EXPECT_EQ(count_self_intersections(soup, places, triangles, 100'000, threads).pairs, expected) << size;
            found += expected;
        }
    EXPECT_GT(found, 100u);
}

TEST(Findings, CornersAtTheSamePlaceAreNoIntersection) {
    const PolygonSoup soup = shapes::icosphere(2);
    const MeshFindings found = inspect(shapes::split(soup));
    EXPECT_EQ(found.self_intersections, 0u);
    EXPECT_EQ(found.components, soup.facets());
}

TEST(Findings, MeaninglessMeshesAreRefused) {
    EXPECT_THROW(refuse_if_meaningless(inspect(PolygonSoup{}), "a.off"), UsageError);
    const PolygonSoup line = shapes::polygon({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}});
    EXPECT_THROW(refuse_if_meaningless(inspect(line), "a.off"), UsageError);
    EXPECT_THROW(
        refuse_if_meaningless(inspect(shapes::moved(shapes::cube(), glm::dvec3(1e308), glm::dvec3(0))), "a.off"),
        UsageError);
    EXPECT_NO_THROW(refuse_if_meaningless(inspect(shapes::single_triangle()), "a.off"));
}

TEST(Findings, ANeedleFanIsNoQuadraticMatter) {
    const MeshFindings found = inspect(shapes::needle_fan(65537, 1));
    EXPECT_TRUE(found.closed);
    EXPECT_EQ(found.most_corners, 65537u);
}

// The two ways of finding how facets hang together share nothing.
TEST(Connectivity, HalfEdgesAndEdgesAgree) {
    std::mt19937 random(3);
    int held = 0;
    for (int trial = 0; trial < 300; ++trial) {
        PolygonSoup soup = trial % 2 ? shapes::icosphere(2) : shapes::cube(true);
        if (trial % 3 == 0)
            soup = shapes::merged(soup, shapes::cube());
        // Leave facets out at random; what is left has holes, and often vertices where they meet.
        const unsigned share = 2 + static_cast<unsigned>(trial) % 40;
        const PolygonSoup rest = shapes::kept_facets(soup, [&](std::size_t) { return random() % share != 0; });
        const Connectivity matched(rest, Connectivity::Method::matched_edges), best(rest);
        EXPECT_EQ(best.has_half_edges(), matched->counts().non_manifold_vertices == 0);
        if (!best.has_half_edges())
            continue;
        EXPECT_EQ(best->counts(), matched->counts());
        std::vector<FacetCorner> fan, other_fan;
        for (std::uint32_t vertex = 0; vertex < rest.vertices.size(); ++vertex) {
            best->fan(vertex, fan);
            matched->fan(vertex, other_fan);
            EXPECT_EQ(fan, other_fan);
        }
        ++held;
    }
    EXPECT_GT(held, 50);
}

} // namespace
} // namespace forceshade
