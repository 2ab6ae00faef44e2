// Placement of a mesh, and the triangles that its facets are cut into.
#include "host/mesh/mesh.h"

#include <chrono>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/error.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

using shapes::polygon;

using Corners = std::array<std::uint32_t, 3>;

Mesh prepared(const PolygonSoup& polygons, const MeshPlacement& placement = {}) {
    return prepare_mesh(polygons, placement, VertexNormals::plain);
}

double twice_area_z(const Mesh& mesh, const Corners& triangle) {
    const auto& v = mesh.polygons.vertices;
    const glm::dvec3 u = v[triangle[1]] - v[triangle[0]], w = v[triangle[2]] - v[triangle[0]];
    return u.x * w.y - u.y * w.x;
}

// A triangulation of a plane polygon: every triangle has its orientation, and the areas add up.
void expect_tiling(const Mesh& mesh, double twice_area) {
    double sum = 0;
    for (const Corners& triangle : mesh.triangles.corners) {
        EXPECT_GT(twice_area_z(mesh, triangle), 0);
        sum += twice_area_z(mesh, triangle);
    }
    EXPECT_EQ(mesh.triangles.corners.size(), mesh.polygons.corners.size() - 2);
    EXPECT_NEAR(sum, twice_area, 1e-12 * twice_area);
}

TEST(Placement, ScalesThenTurnsThenMoves) {
    MeshPlacement placement;
    placement.unit = 1e-3;
    placement.scale = 2;
    placement.rotate = {std::numbers::pi / 2, 0, std::numbers::pi / 2};
    placement.translate = {1, 2, 3};
    const Mesh mesh = prepared(polygon({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), placement);
    // About x: y to z, z to -y; then about z: x to y, y to -x. Quarter turns leave no crumbs.
    EXPECT_EQ(mesh.polygons.vertices[0], glm::dvec3(1, 2 + 0.002, 3));
    EXPECT_EQ(mesh.polygons.vertices[1], glm::dvec3(1, 2, 3 + 0.002));
    EXPECT_EQ(mesh.polygons.vertices[2], glm::dvec3(1 + 0.002, 2, 3));
    placement = {};
    placement.rotate = {0, std::numbers::pi / 6, 0};
    const glm::dvec3 turned = prepared(polygon({{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}), placement).polygons.vertices[2];
    EXPECT_NEAR(turned.x, 0.5, 1e-15);
    EXPECT_NEAR(turned.z, std::sqrt(0.75), 1e-15);
    for (double& angle : placement.rotate)
        angle = -3 * std::numbers::pi; // half turns about all axes are none
    const glm::dvec3 back = prepared(polygon({{1, 2, 3}, {0, 1, 0}, {0, 0, 1}}), placement).polygons.vertices[0];
    EXPECT_EQ(back, glm::dvec3(1, 2, 3));
}

TEST(Placement, RefusesWhatIsNoPlacement) {
    for (const double scale : {0.0, -1.0, std::nan(""), 1e300})
        EXPECT_THROW(prepared(shapes::cube(), {.unit = 1, .scale = scale, .rotate = {}, .translate = {}}), UsageError);
    EXPECT_THROW(prepared(shapes::cube(), {.unit = 1, .scale = 1, .rotate = {}, .translate = {1e101, 0, 0}}),
                 UsageError);
}

TEST(Triangles, OfAQuadrilateralHaveTheShorterDiagonal) {
    EXPECT_EQ(prepared(polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}})).triangles.corners,
              (std::vector<Corners>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(prepared(polygon({{0, 0, 0}, {1, 0, 0}, {3, 3, 0}, {0, 1, 0}})).triangles.corners,
              (std::vector<Corners>{{0, 1, 3}, {1, 2, 3}}));
    // From a reflex corner, though the other diagonal is shorter.
    EXPECT_EQ(prepared(polygon({{0, 0, 0}, {4, -1, 0}, {1, 0, 0}, {4, 1, 0}})).triangles.corners,
              (std::vector<Corners>{{0, 1, 2}, {0, 2, 3}}));
    EXPECT_EQ(prepared(polygon({{4, -1, 0}, {1, 0, 0}, {4, 1, 0}, {0, 0, 0}})).triangles.corners,
              (std::vector<Corners>{{0, 1, 3}, {1, 2, 3}}));
}

TEST(Triangles, OfAStarTileIt) {
    std::vector<glm::dvec3> vertices;
    double twice_area = 0;
    for (int i = 0; i < 41; ++i) {
        const double angle = 2 * std::numbers::pi * i / 41, radius = i % 2 ? 0.3 : 1;
        vertices.emplace_back(radius * std::cos(angle), radius * std::sin(angle), 0);
    }
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        const glm::dvec3 &a = vertices[i], &b = vertices[(i + 1) % vertices.size()];
        twice_area += a.x * b.y - a.y * b.x;
    }
    expect_tiling(prepared(polygon(vertices)), twice_area);
    const Mesh again = prepared(polygon(vertices));
    EXPECT_EQ(again.triangles.corners, prepared(polygon(vertices)).triangles.corners);
}

TEST(Triangles, KeepTheirFacetsOrientation) {
    for (const glm::dvec3& axis : {glm::dvec3(1, 0, 0), glm::dvec3(0, -1, 0), glm::dvec3(0.5, 0.6, -0.7)}) {
        const Mesh prism = prepared(shapes::moved(shapes::many_gon_prism(9), glm::dvec3(1), axis));
        for (std::size_t i = 0; i < prism.triangles.corners.size(); ++i) {
            const glm::dvec3 &n = prism.triangles.normals[i], &f = prism.facet_normals[prism.triangles.facets[i]];
            EXPECT_GT(n.x * f.x + n.y * f.y + n.z * f.z, 0.999999);
        }
    }
}

TEST(Triangles, OfWhatCannotBeCutAreAFan) {
    const Mesh star = prepared(polygon({{1, 0, 0}, {-0.8, 0.6, 0}, {0.3, -0.95, 0}, {0.3, 0.95, 0}, {-0.8, -0.6, 0}}));
    EXPECT_EQ(star.triangles.corners, (std::vector<Corners>{{0, 1, 2}, {0, 2, 3}, {0, 3, 4}}));
    PolygonSoup twice = polygon({{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {-1, 2, 0}});
    twice.corners[3] = 1;
    EXPECT_EQ(prepared(twice).triangles.corners.size(), 3u);
    const Mesh line = prepared(polygon({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {1, 0, 0}}));
    EXPECT_EQ(line.triangles.corners.size(), 3u);
    EXPECT_EQ(line.triangles.normals[0], glm::dvec3(0));
}

TEST(Triangles, OfManyCornersTakeNoTime) {
    const auto start = std::chrono::steady_clock::now();
    const Mesh mesh = prepared(shapes::many_gon_prism(65537));
    EXPECT_LT(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
              5); // 0.2 s, or 1 s sanitized
    EXPECT_EQ(mesh.triangles.corners.size(), mesh.polygons.corners.size() - 2 * mesh.polygons.facets());
}

// A plane facet cut into triangles far from the origin and in any unit stays plane.
TEST(Triangles, DoNotDependOnPlaceAndUnit) {
    const PolygonSoup prism = shapes::many_gon_prism(33);
    const Mesh here = prepared(prism);
    for (const double unit : {0x1p-40, 0x1p-10, 0x1p30})
        EXPECT_EQ(prepared(prism, {.unit = unit, .scale = 1, .rotate = {}, .translate = {}}).triangles.corners,
                  here.triangles.corners);
    const Mesh far = prepared(prism, {.unit = 1, .scale = 1, .rotate = {}, .translate = {1e6, 2e6, -3e6}});
    for (std::size_t i = 0; i < far.facet_normals.size(); ++i)
        EXPECT_LT(glm::dvec3(far.facet_normals[i] - here.facet_normals[i]).x, 1e-8);
    EXPECT_EQ(far.triangles.corners.size(), here.triangles.corners.size());
}

} // namespace
} // namespace forceshade
