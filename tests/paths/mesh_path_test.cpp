// The god-object along recorded strokes over meshes: force and depth from the plane of the facet that it names, and a
// history for each path.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>
#include <glm/geometric.hpp>

#include "tests/mesh/shapes.h"
#include "tests/mesh/written_files.h"
#include "tests/paths/path_workplace.h"

namespace forceshade::testing {
namespace {

constexpr double kStiffness = 1000; /* N/m, the scenes' default */

class MeshPath : public PathWorkplace {
protected:
    std::string scene(const PolygonSoup& polygons, const std::string& more = "") const {
        write("mesh.obj", as_obj(polygons));
        return "[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\n" + more;
    }
    std::string row(int path, const glm::dvec3& p) const {
        return fmt::format("{},{},{},{},{}\n", path, rows_++, p.x, p.y, p.z);
    }

    std::vector<Felt> stroke(const std::string& scene, const std::string& rows,
                             Precision precision = Precision::f64) const {
        return felt_rows(felt(prepare(scene, precision), "path,t,x,y,z\n" + rows));
    }

    mutable int rows_ = 0; // a second each
};

struct Plane {
    glm::dvec3 point, normal;
};

Plane plane_of(const PolygonSoup& triangles, int facet) {
    const auto outline = triangles.outline(std::uint32_t(facet));
    const glm::dvec3 &a = triangles.vertices[outline[0]], &b = triangles.vertices[outline[1]],
                     &c = triangles.vertices[outline[2]];
    return {a, glm::normalize(glm::cross(b - a, c - a))};
}

// Spirals inward from 1 mm above to 1 mm below the surface, over the whole sphere.
std::vector<glm::dvec3> spiral(double radius, int steps) {
    std::vector<glm::dvec3> probes;
    for (int i = 0; i <= steps; ++i) {
        const double s = double(i) / steps, along = std::numbers::pi * (0.02 + 0.96 * s), round = 40 * s;
        const double r = radius + 0.001 * std::cos(std::min(1.0, 20 * s) * std::numbers::pi);
        probes.push_back(
            {r * std::sin(along) * std::cos(round), r * std::sin(along) * std::sin(round), r * std::cos(along)});
    }
    return probes;
}

TEST_F(MeshPath, OverASphereFeelsTheFacetThatItNames) {
    const double radius = 0.025;
    const PolygonSoup triangles = shapes::moved(shapes::icosphere(3), glm::dvec3(radius), {});
    std::string rows;
    for (const glm::dvec3& probe : spiral(radius, 5000))
        rows += row(0, probe);
    for (const Precision precision : {Precision::f64, Precision::f32}) {
        const double tolerance = precision == Precision::f64 ? 1e-16 : 1e-8; /* m */
        std::set<int> facets;
        int free = 0;
        for (const Felt& felt : stroke(scene(triangles), rows, precision)) {
            if (felt.facet < 0) {
                ++free;
                EXPECT_EQ(felt.depth, 0);
                EXPECT_EQ(glm::length(felt.force), 0);
                EXPECT_LT(glm::length(felt.proxy - felt.probe), 2 * tolerance);
                EXPECT_GT(glm::length(felt.probe), 0.99 * radius);
                continue;
            }
            facets.insert(felt.facet);
            // Unshaded, on one facet: F = K d n and g = p + d n, d the depth along the facet's normal n.
            const auto& [point, normal] = plane_of(triangles, felt.facet);
            const double depth = glm::dot(normal, point - felt.probe);
            EXPECT_NEAR(felt.depth, depth, tolerance);
            EXPECT_LT(glm::length(felt.force - kStiffness * depth * normal), kStiffness * tolerance);
            EXPECT_LT(glm::length(felt.proxy - (felt.probe + depth * normal)), tolerance);
            // The facets are chords: below the sphere by less than 1 % of its radius.
            EXPECT_NEAR(felt.depth, radius - glm::length(felt.probe), 0.01 * radius);
        }
        EXPECT_GT(facets.size(), 300u);
        EXPECT_GT(free, 50);
        EXPECT_LT(free, 300);
    }
}

// A path that begins within the sphere is pushed out at the nearest place, and stays in front.
TEST_F(MeshPath, ThatBeginsBehindTheSurfaceBeginsAtTheNearestPlaceAndIsSaidTo) {
    const double radius = 0.025;
    const PolygonSoup triangles = shapes::moved(shapes::icosphere(3), glm::dvec3(radius), {});
    std::string rows = row(4, {0, 0, 0.03}) + row(7, {0, 0, 0}) + row(5, {0, 0, 0.01});
    for (const glm::dvec3& probe : spiral(radius, 5000))
        rows += row(7, probe);
    for (const char* shading : {"none", "morgenbesser", "mean_value", "two_pass"}) {
        int held = 0;
        for (const Felt& felt : stroke(scene(triangles, fmt::format("[force]\nshading = \"{}\"\n", shading)), rows)) {
            if (felt.facet < 0)
                continue;
            ++held;
            const glm::dvec3 normal = plane_of(triangles, felt.facet).normal;
            EXPECT_NEAR(felt.depth, glm::length(felt.proxy - felt.probe), 1e-16);
            const double size = kStiffness * felt.depth;
            EXPECT_GE(glm::length(felt.force), size * (1 - 1e-12));
            EXPECT_LE(glm::length(felt.force), size * (shading == std::string("two_pass") ? 1.01 : 1 + 1e-12))
                << "only two_pass divides by a cosine";
            EXPECT_GT(glm::dot(felt.force, normal), 0.99 * size);
        }
        EXPECT_GT(held, 100);
        EXPECT_EQ(explore(prepare(scene(triangles)), "in.csv").began_inside, 2u);
    }
}

TEST_F(MeshPath, FeelsTextureAlikeFromBothSides) {
    const std::string texture =
        "[texture]\nstiffness = \"0.5 N/mm\"\nfunction = \"sine\"\nwidth = \"2 mm\"\nheight = \"0.1 mm\"\n";
    const PolygonSoup sheet = shapes::polygon({{-0.01, -0.01, 0}, {0.01, -0.01, 0}, {0.01, 0.01, 0}, {-0.01, 0.01, 0}});
    // The second comes to the other side round the border: below it a path would begin behind the surface.
    std::string rows = row(1, {0, 0, 0.001});
    for (const glm::dvec3& probe : {glm::dvec3{0.03, 0, 0}, {0.03, 0, -0.001}, {0, 0, -0.001}})
        rows += row(2, probe);
    for (int i = 0; i < 100; ++i)
        for (const int path : {1, 2})
            rows += row(path, {i * 5e-5, 0, path == 1 ? -0.001 : 0.001});
    for (const char* shading : {"none", "mean_value"}) {
        const auto felt = stroke(scene(sheet, fmt::format("[force]\nshading = \"{}\"\n", shading) + texture), rows);
        double largest = 0;
        ASSERT_EQ(felt.size(), 204u);
        for (std::size_t i = 1; i <= 100; ++i) { // of the second path, samples 3 on are below
            EXPECT_NEAR(felt[i].force.z, 1, 1e-13);
            EXPECT_NEAR(felt[i + 103].force.z, -1, 1e-13);
            EXPECT_NEAR(felt[i].force.x, felt[i + 103].force.x, 1e-13);
            largest = std::max(largest, std::abs(felt[i].force.x));
        }
        EXPECT_NEAR(largest, 500 * 0.001 * 0.0001 * 2 * std::numbers::pi / 0.002, 0.01);
    }
}

// The same probes on both sides of a plate: each path keeps to the side that it came from.
TEST_F(MeshPath, KeepsAHistoryForEachPath) {
    const double thick = 1e-5;
    std::string above = row(1, {0, 0, 0.001}), below = row(2, {0, 0, -0.001}), both = above + below;
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 probe{i * 1e-5, 0, 0.002 * std::sin(i * 0.1)};
        const std::string rows[]{row(1, probe), row(2, probe)};
        above += rows[0];
        below += rows[1];
        both += rows[0] + rows[1];
    }
    const std::string plates = scene(shapes::moved(shapes::cube(), {0.01, 0.01, thick / 2}, {0, 0, -thick / 2}));
    const auto rows = rows_of(felt(prepare(plates), "path,t,x,y,z\n" + both));
    const auto apart = {rows_of(felt(prepare(plates), "path,t,x,y,z\n" + above)),
                        rows_of(felt(prepare(plates), "path,t,x,y,z\n" + below))};
    ASSERT_EQ(rows.size(), 1002u);
    for (std::size_t i = 0; i < rows.size(); ++i)
        EXPECT_EQ(rows[i], (apart.begin() + i / 501)->at(i % 501));
    for (std::size_t i = 1; i < 501; ++i) {
        const double z = number_in<double>(rows[i][4]);
        EXPECT_NEAR(number_in<double>(rows[i][10]), kStiffness * std::max(0.0, -z), 1e-13);
        EXPECT_NEAR(number_in<double>(rows[i + 501][10]), -kStiffness * std::max(0.0, z + thick), 1e-13);
    }
}

} // namespace
} // namespace forceshade::testing
