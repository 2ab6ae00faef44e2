// The structure of a mesh: its frame, its tree's bounds and depth, what lies across edges, its size, and that threads
// change nothing.
#include <bit>
#include <cmath>
#include <cstring>
#include <random>
#include <set>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/mesh/structure.h"
#include "tests/mesh/shapes.h"
#include "tests/mesh/structure_check.h"

namespace forceshade {
namespace {

using layout::uint;

/// Checks the structure of the polygons; gives the tree's depth.
unsigned checked_depth(const PolygonSoup& polygons) {
    const shapes::StructureCheck check = shapes::check_structure(build_structure(shapes::mesh_of(polygons)));
    EXPECT_EQ(check.fault, "");
    return check.depth;
}

TEST(Structure, EveryTriangleIsInOneLeafWithinAllBoxesAboveItAndNextToItsNeighbours) {
    for (const PolygonSoup& polygons :
         {shapes::single_triangle(), shapes::cube(), shapes::icosphere(4), shapes::random_polyhedra(300, 5),
          shapes::needle_fan(1000, 3), shapes::sliver_box(300, 1e8)})
        EXPECT_LE(checked_depth(polygons), reference::kMeshTreeDepth);
}

TEST(Structure, TheSameFacetTenThousandTimesMakesNoDeepTree) {
    PolygonSoup polygons = shapes::single_triangle();
    for (int i = 1; i < 10000; ++i)
        shapes::add_facet(polygons, {0, 1, 2});
    EXPECT_LE(checked_depth(polygons), 12u);
}

TEST(Structure, SizesThatShrinkGeometricallyMakeNoDeepTree) {
    // Each triangle half as large as the one before: the heuristic splits off one by one.
    PolygonSoup polygons;
    for (std::uint32_t i = 0; i < 400; ++i) {
        const double size = std::ldexp(1.0, -int(i) / 4) * (1 + 0.1 * (i % 4));
        for (const glm::dvec3& corner : {glm::dvec3(0), {1, 0, 0}, {0, 1, 0}})
            polygons.vertices.push_back(size * (corner + 1.0));
        shapes::add_facet(polygons, {3 * i, 3 * i + 1, 3 * i + 2});
    }
    EXPECT_LE(checked_depth(polygons), reference::kMeshTreeDepth);
}

// Areas of 1e-162, whose squares are denormal, about the centre of a frame of size 1.
TEST(Structure, TrianglesTooSmallForANormalHaveNoSlab) {
    PolygonSoup polygons;
    const auto add_triangle = [&](const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c) {
        const auto first = static_cast<std::uint32_t>(polygons.vertices.size());
        polygons.vertices.insert(polygons.vertices.end(), {a, b, c});
        shapes::add_facet(polygons, {first, first + 1, first + 2});
    };
    for (const double side : {-1.0, 1.0})
        add_triangle({side, -1, -1}, {side, 1, -1}, {side, 0, 1});
    for (int i = 0; i < 64; ++i)
        add_triangle(1.6e-81 * glm::dvec3(i % 8, i / 8, 0), 1.6e-81 * glm::dvec3(i % 8 + 1, i / 8, 0),
                     1.6e-81 * glm::dvec3(i % 8, i / 8 + 1, 0.1 * (i % 3)));
    checked_depth(polygons);
}

template <typename T> bool equal_bytes(const std::vector<T>& one, const std::vector<T>& other) {
    return one.size() == other.size() && std::memcmp(one.data(), other.data(), one.size() * sizeof(T)) == 0;
}

TEST(Structure, DoesNotDependOnTheNumberOfThreads) {
    const Mesh mesh = shapes::mesh_of(shapes::merged(shapes::icosphere(6), shapes::random_polyhedra(2000, 9)));
    const MeshStructure one = build_structure(mesh, {.threads = 1, .winding = true});
    for (const unsigned threads : {2u, 3u, 8u}) {
        const MeshStructure other = build_structure(mesh, {.threads = threads, .winding = true});
        EXPECT_TRUE(equal_bytes(one.parts->nodes, other.parts->nodes));
        EXPECT_TRUE(equal_bytes(one.parts->triangle_corners, other.parts->triangle_corners));
        EXPECT_TRUE(equal_bytes(one.parts->triangle_neighbours, other.parts->triangle_neighbours));
        EXPECT_TRUE(equal_bytes(one.reals->vertices, other.reals->vertices));
        EXPECT_TRUE(equal_bytes(one.reals->vertex_pseudonormals, other.reals->vertex_pseudonormals));
        EXPECT_TRUE(equal_bytes(one.winding->moments, other.winding->moments));
    }
}

// Sums round by the triangles' order, which is the tree's: forces on marginal places move with it.
TEST(Structure, TheTreeStaysTheSame) {
    const MeshStructure structure =
        build_structure(shapes::mesh_of(shapes::merged(shapes::icosphere(5), shapes::random_polyhedra(500, 9))));
    std::uint64_t hash = 0;
    for (const layout::uint facet : structure.parts->triangle_facets)
        hash = (hash ^ facet) * 0x9E3779B97F4A7C15u + (hash >> 29);
    for (const layout::MeshNode& node : structure.parts->nodes)
        for (const layout::uint child : node.child)
            hash = (hash ^ child) * 0x9E3779B97F4A7C15u + (hash >> 29);
    EXPECT_EQ(hash, 0xbb60d86bbd2b2a14u);
}

TEST(Structure, IsAsSmallAsItSays) {
    const MeshStructure plain = build_structure(shapes::mesh_of(shapes::icosphere(6)));
    const MeshStructure winding = build_structure(shapes::mesh_of(shapes::icosphere(6)), {.winding = true});
    const double triangles = double(plain.triangles());
    EXPECT_LT(double(plain.bytes()) / triangles, 164);
    EXPECT_LT(double(winding.bytes()) / triangles, 198);
    // Nothing grows beyond what is in it.
    const MeshParts& parts = *plain.parts;
    EXPECT_EQ(parts.triangle_corners.size(), 3 * plain.triangles());
    EXPECT_EQ(plain.reals->vertices.size(), 3 * (plain.triangles() / 2 + 2));
    EXPECT_TRUE(plain.reals->edge_pseudonormals.empty());
}

TEST(Structure, FrameIsTheLeastPowerOfTwoAboutTheMiddle) {
    const glm::dvec3 shift(5e5, -3, 1e-9);
    for (const double size : {1e-30, 1e-12, 0.37, 1.0, 3e7, 1e30}) {
        const MeshStructure structure =
            build_structure(shapes::mesh_of(shapes::moved(shapes::icosphere(2), glm::dvec3(size), size * shift)));
        int exponent;
        EXPECT_EQ(std::frexp(structure.scale, &exponent), 0.5);
        double largest = 0;
        for (const double coordinate : structure.reals->vertices)
            largest = std::max(largest, std::abs(coordinate));
        EXPECT_LE(largest, 1);
        EXPECT_GT(largest, 0.5);
        EXPECT_NEAR(structure.centre.x / size, shift.x, 1e-9);
    }
}

TEST(Structure, FrameOfAnExactPowerOfTwoIsThatPower) {
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::cube()));
    EXPECT_EQ(structure.scale, 1);
    EXPECT_EQ(structure.centre, glm::dvec3(0));
}

TEST(Structure, PlacesOfFarMeshesAreMeasuredFromNearThem) {
    const auto placed = [](double size, const glm::dvec3& at) {
        return build_structure(shapes::mesh_of(shapes::moved(shapes::cube(), glm::dvec3(size), at)));
    };
    EXPECT_EQ(origin_of(placed(1, {3.9, -3.9, 0})), glm::dvec3(0));
    EXPECT_EQ(origin_of(placed(1, {4.3, -1000.75, 3})), glm::dvec3(4, -1001, 0));
    EXPECT_EQ(origin_of(placed(0.25, {4.3, 0, 1e7})), glm::dvec3(4.25, 0, 1e7));
    const MeshStructure far = placed(1, {566321.25, -5933204.5, 12});
    const MeshTables<float> tables = make_mesh_tables<float>(far, 1);
    EXPECT_EQ(glm::dvec3(tables.params.centre_x, tables.params.centre_y, tables.params.centre_z),
              far.centre - origin_of(far));
    EXPECT_EQ(tables.params.map_y, -5933204.5F);
}

TEST(Structure, VerticesAtOnePlaceAreOneForTheEdges) {
    // The icosphere as a heap of single triangles, as an STL file has it.
    const MeshStructure structure =
        build_structure(shapes::mesh_of(shapes::split(shapes::icosphere(2))), {.winding = true});
    EXPECT_EQ(shapes::check_structure(structure).fault, "");
    EXPECT_TRUE(structure.winding->rims.empty());
}

TEST(Structure, BordersAndFansAreToldApart) {
    // Three triangles on one edge.
    const PolygonSoup fan =
        shapes::soup_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, -1, 0}}, {{0, 1, 2}, {0, 1, 3}, {1, 0, 4}});
    const MeshStructure structure = build_structure(shapes::mesh_of(fan), {.winding = true});
    int borders = 0, many = 0;
    for (const uint across : structure.parts->triangle_neighbours) {
        borders += across == layout::kMeshBorder;
        many += across != layout::kMeshBorder && (across & layout::kMeshManyBit) != 0;
    }
    EXPECT_EQ(borders, 6);
    EXPECT_EQ(many, 3);
    ASSERT_EQ(structure.reals->edge_pseudonormals.size(), 3u);
    // (0, 0, 1) + (0, -1, 0) + (0, 0, 1)
    EXPECT_NEAR(structure.reals->edge_pseudonormals[1], -1, 1e-15);
    EXPECT_NEAR(structure.reals->edge_pseudonormals[2], 2, 1e-15);
    EXPECT_EQ(structure.winding->rims.size(), 3u * 7);
}

TEST(Structure, PseudonormalsOfACubeAreDiagonal) {
    for (const bool triangles : {false, true}) {
        const MeshStructure structure = build_structure(shapes::mesh_of(shapes::cube(triangles)));
        for (std::size_t i = 0; i < structure.reals->vertices.size(); ++i)
            EXPECT_NEAR(structure.reals->vertex_pseudonormals[i],
                        std::copysign(std::acos(0.0), structure.reals->vertices[i]), 1e-14);
    }
}

TEST(Structure, WhatHasNoAreaIsLeftOut) {
    PolygonSoup polygons = shapes::cube(true);
    const auto first = static_cast<std::uint32_t>(polygons.vertices.size());
    polygons.vertices.push_back({-1, -1, 0});
    shapes::add_facet(polygons, {0, first, 4});
    shapes::add_facet(polygons, {3, 3, 3});
    // The first one says that its vertex lies on an edge: the two triangles there are cut.
    EXPECT_EQ(build_structure(shapes::mesh_of(polygons)).triangles(), 14u);
    const PolygonSoup line = shapes::polygon({{0, 0, 0}, {1, 1, 1}, {2, 2, 2}});
    EXPECT_THROW(build_structure(shapes::mesh_of(line)), UsageError);
    EXPECT_THROW(build_structure(shapes::mesh_of(PolygonSoup{})), UsageError);
}

TEST(Structure, AVertexThatNoFacetUsesHasNoSay) {
    PolygonSoup polygons = shapes::cube();
    polygons.vertices.push_back({1e9, 0, 0});
    const MeshStructure structure = build_structure(shapes::mesh_of(polygons));
    EXPECT_EQ(structure.scale, 1);
    EXPECT_EQ(structure.reals->vertices.size(), 24u);
}

TEST(Tables, ForcesThatNoNumberCanHoldAreRefused) {
    const auto sphere = [](double size) {
        return build_structure(shapes::mesh_of(shapes::moved(shapes::icosphere(1), glm::dvec3(size), {})));
    };
    EXPECT_NO_THROW(make_mesh_tables<double>(sphere(1e30), 1000));
    EXPECT_NO_THROW(make_mesh_tables<double>(sphere(1e-30), 1000));
    EXPECT_NO_THROW(make_mesh_tables<float>(sphere(1e30), 1000));
    EXPECT_NO_THROW(make_mesh_tables<float>(sphere(1e-30), 1000));
    EXPECT_THROW(make_mesh_tables<float>(sphere(1e30), 1e20), UsageError);
    EXPECT_THROW(make_mesh_tables<float>(sphere(1e-30), 1e-20), UsageError);
    EXPECT_THROW(make_mesh_tables<float>(sphere(1e-42), 1), UsageError);
    EXPECT_THROW(make_mesh_tables<double>(sphere(1e30), 1e300), UsageError);
    EXPECT_NO_THROW(make_mesh_tables<float>(sphere(1), 0));
}

TEST(Tables, OfSinglePrecisionHoldTheDoublesRoundedOnce) {
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::icosphere(2)));
    const MeshTables<float> single = make_mesh_tables<float>(structure, 1000);
    const MeshTables<double> twofold = make_mesh_tables<double>(structure, 1000);
    EXPECT_EQ(twofold.reals.get(), structure.reals.get());
    EXPECT_EQ(single.parts.get(), twofold.parts.get());
    for (std::size_t i = 0; i < structure.reals->vertices.size(); ++i)
        EXPECT_EQ(single.view().vertices[i], static_cast<float>(structure.reals->vertices[i]));
}

// By a ray from above through every triangle, solved as a plane.
std::optional<double> highest(const Mesh& mesh, double x, double y) {
    std::optional<double> best;
    for (const auto& corners : mesh.triangles.corners) {
        const glm::dvec3 &a = mesh.polygons.vertices[corners[0]], &b = mesh.polygons.vertices[corners[1]],
                         &c = mesh.polygons.vertices[corners[2]];
        const double whole = (b.x - a.x) * (c.y - a.y) - (c.x - a.x) * (b.y - a.y);
        const double u = ((x - a.x) * (c.y - a.y) - (c.x - a.x) * (y - a.y)) / whole;
        const double v = ((b.x - a.x) * (y - a.y) - (x - a.x) * (b.y - a.y)) / whole;
        if (u >= 0 && v >= 0 && u + v <= 1)
            best = std::max(best.value_or(-1e300), a.z + u * (b.z - a.z) + v * (c.z - a.z));
    }
    return best;
}

TEST(Structure, HeightIsThatOfTheHighestTriangle) {
    const Mesh mesh = shapes::mesh_of(shapes::merged(shapes::random_polyhedra(200, 4), shapes::icosphere(3)));
    const MeshStructure structure = build_structure(mesh);
    std::mt19937 random(11);
    int above = 0;
    for (int i = 0; i < 3000; ++i) {
        const double x = 1.5 * shapes::uniform(random), y = 1.5 * shapes::uniform(random);
        const std::optional<double> found = height_at(structure, x, y), expected = highest(mesh, x, y);
        ASSERT_EQ(found.has_value(), expected.has_value()) << x << ", " << y;
        if (found) {
            EXPECT_NEAR(*found, *expected, 1e-12);
        }
        above += found.has_value();
    }
    EXPECT_GT(above, 500);
    // No gap on edges and corners.
    const MeshStructure cube = build_structure(shapes::mesh_of(shapes::cube(true)));
    for (const double x : {-1.0, -0.5, 0.0, 0.25, 1.0})
        for (const double y : {-1.0, -0.25, 0.0, 0.5, 1.0})
            EXPECT_EQ(height_at(cube, x, y), std::optional(1.0));
    EXPECT_EQ(height_at(cube, 1.0000001, 0), std::nullopt);
}

} // namespace
} // namespace forceshade
