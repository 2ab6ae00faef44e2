// Normals of triangles of every shape, of facets and of vertices.
#include "host/error.h"
#include "host/mesh/connectivity.h"
#include "host/mesh/findings.h"
#include "host/mesh/mesh.h"
#include "host/mesh/mesh_file.h"

#include <cmath>
#include <numbers>
#include <random>

#include <CGAL/Exact_rational.h>
#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using Rational = CGAL::Exact_rational;
constexpr double kUlp = 0x1p-52;

double length(const glm::dvec3& v) {
    return std::hypot(v.x, v.y, v.z);
}

// The largest difference of a unit normal from the exact one; 2 if the one is 0 and the other is not.
double error(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& found) {
    std::array<Rational, 3> u, v, n;
    for (int i = 0; i < 3; ++i) {
        u[static_cast<std::size_t>(i)] = Rational(b[i]) - Rational(a[i]);
        v[static_cast<std::size_t>(i)] = Rational(c[i]) - Rational(b[i]); // not the edges that the function takes
    }
    Rational largest(0);
    for (std::size_t i = 0; i < 3; ++i) {
        n[i] = u[(i + 1) % 3] * v[(i + 2) % 3] - u[(i + 2) % 3] * v[(i + 1) % 3];
        largest = std::max(largest, Rational(CGAL::abs(n[i])));
    }
    if (largest == 0)
        return found == glm::dvec3(0) ? 0 : 2;
    glm::dvec3 expected;
    for (int i = 0; i < 3; ++i)
        expected[i] = CGAL::to_double(Rational(n[static_cast<std::size_t>(i)] / largest));
    expected /= length(expected);
    return length(found - expected);
}

TEST(TriangleNormal, IsGoodToAFewUlpsWhateverTheShape) {
    std::mt19937 random(5);
    std::uniform_real_distribution<double> uniform(-1, 1);
    const auto vector = [&] { return glm::dvec3(uniform(random), uniform(random), uniform(random)); };
    double worst = 0;
    for (int trial = 0; trial < 20000; ++trial) {
        const double thinness = std::pow(10.0, -16 * std::abs(uniform(random)));
        const double size = std::pow(10.0, 90 * uniform(random) * (trial % 2));
        const glm::dvec3 shift = (trial % 3 == 0 ? 1e6 : 0.0) * vector();
        const glm::dvec3 a = vector(), edge = vector();
        // Caps (the third corner near the middle of the edge) and needles (near its end).
        const glm::dvec3 c = a + (trial % 5 == 0 ? 1.0 : uniform(random)) * edge + thinness * vector();
        const glm::dvec3 p = size * (a + shift), q = size * (a + edge + shift), r = size * (c + shift);
        worst = std::max(worst, error(p, q, r, triangle_normal(p, q, r)));
    }
    EXPECT_LE(worst, 3 * kUlp);
}

// Collinear corners whose differences are rounded: only exact arithmetic can tell.
TEST(TriangleNormal, IsZeroOnlyForNoArea) {
    const glm::dvec3 a(1e-20, 3e-20, 7e-20), b(1, 3, 7);
    EXPECT_EQ(triangle_normal(a, a, b), glm::dvec3(0));
    EXPECT_EQ(triangle_normal(b, 2.0 * b, 1024.0 * b), glm::dvec3(0));
    EXPECT_EQ(triangle_normal(glm::dvec3(0), b, 3.0 * b), glm::dvec3(0));
    const glm::dvec3 beside(3, 9, std::nextafter(21.0, 22.0));
    EXPECT_LE(error(glm::dvec3(0), b, beside, triangle_normal(glm::dvec3(0), b, beside)), 3 * kUlp);
    const glm::dvec3 thin = triangle_normal(a, b, 3.0 * b);
    EXPECT_LE(error(a, b, 3.0 * b, thin), 3 * kUlp);
}

TEST(FacetNormals, OfAPlaneAndOfAWarpedFacet) {
    for (const glm::dvec3& normal : facet_normals(shapes::cube()))
        EXPECT_EQ(length(normal), 1);
    // Newell's normal of a regular saddle is its axis.
    const PolygonSoup saddle = shapes::polygon({{1, 0, .3}, {0, 1, -.3}, {-1, 0, .3}, {0, -1, -.3}}),
                      bow_tie = shapes::polygon({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}});
    EXPECT_LE(length(facet_normals(saddle)[0] - glm::dvec3(0, 0, 1)), 2 * kUlp);
    EXPECT_EQ(facet_normals(bow_tie)[0], glm::dvec3(0));
}

TEST(FacetNormals, OfAThinQuadrilateralFarFromTheOrigin) {
    const glm::dvec3 corner(1e6, -2e6, 3e6);
    const PolygonSoup soup =
        shapes::polygon({corner, corner + glm::dvec3(1, 0, 0), corner + glm::dvec3(1, 0x1p-26, 0x1p-26),
                         corner + glm::dvec3(0, 0x1p-26, 0x1p-26)});
    EXPECT_LE(length(facet_normals(soup)[0] - glm::dvec3(0, -1, 1) / std::sqrt(2.0)), 2 * kUlp);
}

TEST(VertexNormals, PlainCountsFacetsAndAngleDoesNot) {
    const double third = 1 / std::sqrt(3.0);
    const auto corner_error = [&](const PolygonSoup& soup, VertexNormals weights) {
        const std::vector<glm::dvec3> normals = vertex_normals(soup, facet_normals(soup), weights);
        double worst = 0;
        for (std::size_t i = 0; i < 8; ++i)
            worst = std::max(worst, length(normals[i] - third * soup.vertices[i]));
        return worst;
    };
    EXPECT_LE(corner_error(shapes::cube(), VertexNormals::plain), 4 * kUlp);
    EXPECT_LE(corner_error(shapes::cube(), VertexNormals::angle), 4 * kUlp);
    EXPECT_LE(corner_error(shapes::cube(true), VertexNormals::angle), 8 * kUlp);
    EXPECT_GT(corner_error(shapes::cube(true), VertexNormals::plain), 0.1);
}

TEST(VertexNormals, ReflexCornersWeighWithTheirWholeAngle) {
    // An arrow head in the plane, and a wall at its reflex corner: a right angle there, facing +x.
    const PolygonSoup soup =
        shapes::soup_of({{0, 0, 0}, {1, -1, 0}, {0, 2, 0}, {-1, -1, 0}, {0, 0, 1}}, {{0, 1, 2, 3}, {0, 2, 4}});
    const glm::dvec3 normal = vertex_normals(soup, facet_normals(soup), VertexNormals::angle)[0];
    const glm::dvec3 expected(std::numbers::pi / 2, 0, 1.5 * std::numbers::pi); // 270 degrees
    EXPECT_LE(length(normal - expected / length(expected)), 4 * kUlp);
}

TEST(VertexNormals, CancellingNormalsGiveNone) {
    PolygonSoup soup = shapes::single_triangle();
    const std::uint32_t a = soup.corners[0], b = soup.corners[1], c = soup.corners[2];
    shapes::add_facet(soup, {c, b, a});
    for (const VertexNormals weights : {VertexNormals::plain, VertexNormals::angle})
        for (const glm::dvec3& normal : vertex_normals(soup, facet_normals(soup), weights))
            EXPECT_EQ(normal, glm::dvec3(0));
    const PolygonSoup vane = shapes::soup_of( // three walls at 120 degrees: their normals cancel but for rounding
        {{0, 0, 0}, {0, 0, 1}, {1, 0, 0}, {-0.5, std::sqrt(0.75), 0}, {-0.5, -std::sqrt(0.75), 0}},
        {{0, 1, 2}, {0, 1, 3}, {0, 1, 4}});
    EXPECT_EQ(vertex_normals(vane, facet_normals(vane), VertexNormals::plain)[0], glm::dvec3(0));
    EXPECT_NE(vertex_normals(vane, facet_normals(vane), VertexNormals::plain)[2], glm::dvec3(0));
    const PolygonSoup degenerate = shapes::polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}});
    EXPECT_EQ(vertex_normals(degenerate, facet_normals(degenerate), VertexNormals::plain)[1], glm::dvec3(0));
}

// Two triangles that share an edge, one normal a corner: as OBJ and as PLY.
const std::string kRoof = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 1\nvn 0 0 2\nvn 1 0 1\nvn 0 0 2\n";

PolygonSoup roof(const std::string& facets) {
    return parse_polygons("a.obj", kRoof + facets, true).polygons;
}

TEST(FileNormals, OfAnObjAreThoseOfItsCorners) {
    const PolygonSoup soup = roof("f 1//1 2//2 3//2\nf 2//2 4/9/3 3//-2\n");
    ASSERT_EQ(soup.normals.size(), 6u);
    EXPECT_EQ(soup.normals[1], glm::dvec3(1, 0, 1));
    EXPECT_EQ(soup.normals[4], glm::dvec3(0, 0, 2));
    EXPECT_EQ(soup.normals[5], glm::dvec3(1, 0, 1));
    EXPECT_EQ(prepare_mesh(soup, {}, VertexNormals::file).polygons.vertices.size(), 4u);
    EXPECT_TRUE(parse_polygons("a.obj", kRoof).polygons.normals.empty());
}

TEST(FileNormals, AVertexWithTwoBecomesTwoAtItsPlace) {
    const PolygonSoup creased = roof("f 1//1 2//1 3//3\nf 2//2 4//2 3//2\n"); // normals 1 and 3 are the same
    EXPECT_EQ(inspect(creased).boundary_edges, 4u);                           // the shared edge is one
    const Mesh mesh = prepare_mesh(creased, {}, VertexNormals::file);
    ASSERT_EQ(mesh.polygons.vertices.size(), 6u);
    EXPECT_EQ(mesh.polygons.vertices[4], mesh.polygons.vertices[1]);
    EXPECT_EQ(mesh.vertex_normals[mesh.polygons.outline(0)[1]], glm::dvec3(0, 0, 1));
    EXPECT_NEAR(mesh.vertex_normals[mesh.polygons.outline(1)[0]].x, std::sqrt(0.5), 1e-15);
    EXPECT_EQ(mesh.triangles.corners, prepare_mesh(creased, {}, VertexNormals::plain).triangles.corners);
}

TEST(FileNormals, OfAPlyAreNxNyNz) {
    const PolygonFile file = parse_polygons("a.ply",
                                            "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float "
                                            "nx\nproperty float y\nproperty float z\nproperty float ny\nproperty float "
                                            "nz\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
                                            "0 0.5 0 0 0 1\n1 0.25 0 0 0 1\n0 0 1 0 0 1\n3 0 1 2\n",
                                            true);
    EXPECT_EQ(file.polygons.vertices[1], glm::dvec3(1, 0, 0));
    ASSERT_EQ(file.polygons.normals.size(), 3u);
    EXPECT_EQ(file.polygons.normals[1], glm::dvec3(0.25, 0, 1));
}

TEST(FileNormals, AreTurnedWithTheMeshAndOfLengthOne) {
    PolygonSoup soup = roof("f 1//1 2//2 3//2\n");
    const Mesh mesh =
        prepare_mesh(soup, {.unit = 1e-3, .scale = 5, .rotate = {0, std::numbers::pi / 2, 0}, .translate = {1, 2, 3}},
                     VertexNormals::file);
    EXPECT_EQ(mesh.vertex_normals[0], glm::dvec3(1, 0, 0)); // about y: z to x, x to -z
    EXPECT_NEAR(mesh.vertex_normals[1].z, -std::sqrt(0.5), 1e-15);
    EXPECT_EQ(mesh.opposed_normals, 0u);
    for (glm::dvec3& normal : soup.normals)
        normal = -normal;
    EXPECT_EQ(prepare_mesh(soup, {}, VertexNormals::file).opposed_normals, 3u);
}

TEST(FileNormals, ThatAreMissingOrNoDirectionAreRefused) {
    EXPECT_THROW(parse_polygons("a.obj", kRoof + "f 1 2 3\n", true), IoError);
    EXPECT_THROW(parse_polygons("a.obj", kRoof + "f 1//1 2//1 3//4\n", true), IoError);
    EXPECT_THROW(parse_polygons("a.obj", kRoof + "vn 0 0 0\nf 1//1 2//1 3//4\n", true), UsageError);
    EXPECT_THROW(parse_polygons("a.obj", kRoof + "vn 0 nan 0\nf 1//1 2//1 3//4\n", true), UsageError);
    EXPECT_THROW(parse_polygons("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", true), UsageError);
    EXPECT_THROW(parse_polygons("a.off", "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n", true), UsageError);
}

// A drum of two lids and 16 sides; its facets' groups are 2 and 3 for the lids, 1 for the side.
PolygonSoup drum() {
    PolygonSoup result = shapes::many_gon_prism(16);
    result.groups = {2, 3};
    result.groups.resize(18, 1);
    return result;
}

TEST(Creases, GroupsAndSharpEdgesShareNoNormals) {
    for (const Smoothing& smoothing : {Smoothing(VertexNormals::groups), Smoothing(VertexNormals::crease, 0.6)}) {
        const Mesh mesh = prepare_mesh(drum(), {}, smoothing);
        EXPECT_EQ(mesh.polygons.vertices.size(), 64u);
        for (std::size_t facet = 0; facet < mesh.polygons.facets(); ++facet)
            for (const std::uint32_t vertex : mesh.polygons.outline(facet)) {
                const glm::dvec3& place = mesh.polygons.vertices[vertex];
                const glm::dvec3 expected =
                    facet > 1 ? glm::dvec3(place.x, place.y, 0) : glm::dvec3(0, 0, facet == 0 ? 1 : -1);
                EXPECT_LT(length(mesh.vertex_normals[vertex] - expected), 1e-14);
            }
    }
    // Sides meet at 22.5 degrees: below that every facet is flat, beyond 90 all share.
    const Mesh flat = prepare_mesh(drum(), {}, Smoothing(VertexNormals::crease, 0.39));
    for (std::size_t facet = 0; facet < flat.polygons.facets(); ++facet)
        for (const std::uint32_t vertex : flat.polygons.outline(facet))
            EXPECT_LT(length(flat.vertex_normals[vertex] - flat.facet_normals[facet]), 1e-14);
    const Mesh all = prepare_mesh(drum(), {}, Smoothing(VertexNormals::crease, 1.6));
    EXPECT_EQ(all.polygons.vertices.size(), 32u);
    EXPECT_EQ(all.vertex_normals, prepare_mesh(drum(), {}).vertex_normals);
}

TEST(Creases, GroupsAreThoseOfAnObj) {
    const std::string facets = "f 1 2 3\ns 4\nf 2 4 3\ns off\nf 1 2 4\ns 7\nf 1 3 4\n";
    EXPECT_EQ(parse_polygons("a.obj", kRoof + facets).polygons.groups, (std::vector<std::uint32_t>{0, 4, 0, 7}));
    EXPECT_TRUE(parse_polygons("a.obj", kRoof + std::string("s off\nf 1 2 3\n")).polygons.groups.empty());
}

TEST(Creases, AFacetOfGroup0IsFlat) {
    PolygonSoup off = drum();
    off.groups.assign(off.facets(), 0);
    const Mesh mesh = prepare_mesh(off, {}, VertexNormals::groups);
    for (std::size_t facet = 0; facet < mesh.polygons.facets(); ++facet)
        for (const std::uint32_t vertex : mesh.polygons.outline(facet))
            EXPECT_LT(length(mesh.vertex_normals[vertex] - mesh.facet_normals[facet]), 1e-14);
}

} // namespace
} // namespace forceshade
