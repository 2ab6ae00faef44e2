// The god-object along recorded strokes over meshes: force and depth from the plane of the facet that it names, and a
// history for each path.
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "tests/paths/path_workplace.h"
#include "tests/paths/polygons.h"

namespace forceshade::testing {
namespace {

constexpr double kStiffness = 1000; /* N/m, the scenes' default */

struct Felt {
    glm::dvec3 probe, proxy, force;
    double depth;
    int facet;
};

class MeshPath : public PathWorkplace {
protected:
    std::string scene(const std::vector<Polygon>& polygons, const std::string& more = "") const {
        write("mesh.obj", obj(polygons));
        return "[surface]\nkind = \"mesh\"\nfile = \"mesh.obj\"\n" + more;
    }
    std::string row(int path, const glm::dvec3& p) const {
        return fmt::format("{},{},{},{},{}\n", path, rows_++, p.x, p.y, p.z);
    }

    std::vector<Felt> stroke(const std::string& scene, const std::string& rows,
                             Precision precision = Precision::f64) const {
        std::vector<Felt> all;
        for (const auto& cells : rows_of(felt(prepare(scene, precision), "path,t,x,y,z\n" + rows))) {
            const auto vector = [&](std::size_t first) {
                return glm::dvec3{number_in<double>(cells[first]), number_in<double>(cells[first + 1]),
                                  number_in<double>(cells[first + 2])};
            };
            all.push_back({vector(2), vector(5), vector(8), number_in<double>(cells[11]), number_in<int>(cells[12])});
        }
        return all;
    }

    // Of the bump, over the plane, m.
    static double height_at(const std::vector<Polygon>& bump, double x) {
        for (const Polygon& polygon : bump)
            if (x >= polygon[0].x && x < polygon[1].x && polygon.size() == 6)
                return std::lerp(polygon[0].z, polygon[1].z, (x - polygon[0].x) / (polygon[1].x - polygon[0].x));
        return 0;
    }

    // Unshaded, on one facet: F = K d n and g = p + d n, d the depth along the facet's normal n.
    static void expect_plane(const Felt& felt, const Polygon& polygon, double tolerance) {
        const Plane plane = plane_of(polygon);
        const double depth = dot(plane.normal, plane.point - felt.probe);
        EXPECT_NEAR(felt.depth, depth, tolerance);
        EXPECT_LT(length(felt.force - kStiffness * depth * plane.normal), kStiffness * tolerance);
        EXPECT_LT(length(felt.proxy - (felt.probe + depth * plane.normal)), tolerance);
    }
    mutable int rows_ = 0; // a second each
};

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
    const std::vector<Polygon> triangles = sphere(radius, 4);
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
                EXPECT_EQ(length(felt.force), 0);
                EXPECT_LT(length(felt.proxy - felt.probe), 2 * tolerance);
                EXPECT_GT(length(felt.probe), 0.99 * radius);
                continue;
            }
            facets.insert(felt.facet);
            expect_plane(felt, triangles.at(std::size_t(felt.facet)), tolerance);
            // The facets are chords: below the sphere by less than 1 % of its radius.
            EXPECT_NEAR(felt.depth, radius - length(felt.probe), 0.01 * radius);
        }
        EXPECT_GT(facets.size(), 300u);
        EXPECT_GT(free, 50);
        EXPECT_LT(free, 300);
    }
}

TEST_F(MeshPath, OverABumpOfPolygonsFeelsThemOneAfterTheOther) {
    for (const int facets : {2, 3, 16}) {
        const std::vector<Polygon> polygons = bump(facets);
        std::string rows;
        for (int i = 0; i <= 4000; ++i) {
            const double x = -0.02 + i * 1e-5;
            rows += row(0, {x, 0.003, height_at(polygons, x) + (i < 100 ? 0.001 : -0.0005)});
        }
        std::vector<int> seen;
        int on_one = 0;
        for (const Felt& felt : stroke(scene(polygons), rows)) {
            if (felt.facet < 0)
                continue;
            EXPECT_LT(length(felt.force - kStiffness * (felt.proxy - felt.probe)), 1e-13);
            EXPECT_NEAR(length(felt.force), kStiffness * felt.depth, 1e-13);
            if (seen.empty() || seen.back() != felt.facet)
                seen.push_back(felt.facet);
            // In the concave edge beside the bump two planes hold the proxy.
            if (std::abs(std::abs(felt.proxy.x) - 0.0127) < 1e-6)
                continue;
            ++on_one;
            expect_plane(felt, polygons.at(std::size_t(felt.facet)), 1e-16);
        }
        EXPECT_GT(on_one, 3000);
        EXPECT_TRUE(std::is_sorted(seen.begin(), seen.end()));
        EXPECT_EQ(seen.size(), std::size_t(facets) + 2) << "the plane, each facet's half beyond y = 0, the plane";
    }
}

TEST_F(MeshPath, KeepsItsMagnitudeWhenShaded) {
    const std::vector<Polygon> polygons = bump(3);
    std::string rows;
    for (int i = 0; i <= 2000; ++i)
        rows += row(0, {-0.01 + i * 1e-5, 0.003, i == 0 ? 0.01 : 0.001});
    const std::vector<Felt> plain = stroke(scene(polygons), rows);
    for (const char* shading : {"morgenbesser", "mean_value"}) {
        const auto shaded = stroke(scene(polygons, fmt::format("[force]\nshading = \"{}\"\n", shading)), rows);
        ASSERT_EQ(shaded.size(), plain.size());
        double turned = 0;
        for (std::size_t i = 1; i < plain.size(); ++i) {
            EXPECT_EQ(shaded[i].proxy, plain[i].proxy);
            EXPECT_EQ(shaded[i].facet, plain[i].facet);
            EXPECT_NEAR(length(shaded[i].force), length(plain[i].force), 1e-12 * length(plain[i].force));
            turned = std::max(turned, length(shaded[i].force - plain[i].force) / length(plain[i].force));
        }
        EXPECT_GT(turned, 0.05);
    }
}

// A path that begins within the sphere is pushed out at the nearest place, and stays in front.
TEST_F(MeshPath, ThatBeginsBehindTheSurfaceBeginsAtTheNearestPlaceAndIsSaidTo) {
    const double radius = 0.025;
    const std::vector<Polygon> triangles = sphere(radius, 4);
    std::string rows = row(4, {0, 0, 0.03}) + row(7, {0, 0, 0}) + row(5, {0, 0, 0.01});
    for (const glm::dvec3& probe : spiral(radius, 5000))
        rows += row(7, probe);
    for (const char* shading : {"none", "morgenbesser", "mean_value", "two_pass"}) {
        int held = 0;
        for (const Felt& felt : stroke(scene(triangles, fmt::format("[force]\nshading = \"{}\"\n", shading)), rows)) {
            if (felt.facet < 0)
                continue;
            ++held;
            const Plane plane = plane_of(triangles.at(std::size_t(felt.facet)));
            EXPECT_NEAR(felt.depth, length(felt.proxy - felt.probe), 1e-16);
            const double size = kStiffness * felt.depth;
            EXPECT_GE(length(felt.force), size * (1 - 1e-12));
            EXPECT_LE(length(felt.force), size * 1.01) << "two_pass divides by a cosine";
            EXPECT_GT(dot(felt.force, plane.normal), 0.99 * size);
        }
        EXPECT_GT(held, 100);
        const auto warnings = explore(prepare(scene(triangles)), "in.csv").warnings;
        ASSERT_EQ(warnings.size(), 1u);
        EXPECT_NE(warnings[0].find("in.csv:3:1: 2 of 3 paths, here the first, begin behind"), std::string::npos)
            << warnings[0];
    }
}

const glm::dvec3 kA{-0.01, -0.01, 0}, kB{0.01, -0.01, 0}, kC{0.01, 0.01, 0}, kD{-0.01, 0.01, 0};

TEST_F(MeshPath, FeelsTextureAlikeFromBothSides) {
    const std::string texture =
        "[texture]\nstiffness = \"0.5 N/mm\"\nfunction = \"sine\"\nwidth = \"2 mm\"\nheight = \"0.1 mm\"\n";
    // The second comes to the other side round the border: below it a path would begin behind the surface.
    std::string rows = row(1, {0, 0, 0.001});
    for (const glm::dvec3& probe : {glm::dvec3{0.03, 0, 0}, {0.03, 0, -0.001}, {0, 0, -0.001}})
        rows += row(2, probe);
    for (int i = 0; i < 100; ++i)
        for (const int path : {1, 2})
            rows += row(path, {i * 5e-5, 0, path == 1 ? -0.001 : 0.001});
    for (const char* shading : {"none", "mean_value"}) {
        const auto felt =
            stroke(scene({{kA, kB, kC, kD}}, fmt::format("[force]\nshading = \"{}\"\n", shading) + texture), rows);
        double largest = 0;
        for (std::size_t i = 4; i < felt.size(); i += 2) {
            EXPECT_NEAR(felt[i].force.z, 1, 1e-13);
            EXPECT_NEAR(felt[i + 1].force.z, -1, 1e-13);
            EXPECT_NEAR(felt[i].force.x, felt[i + 1].force.x, 1e-13);
            largest = std::max(largest, std::abs(felt[i].force.x));
        }
        EXPECT_NEAR(largest, 500 * 0.001 * 0.0001 * 2 * std::numbers::pi / 0.002, 0.01);
    }
}

// The same probes on both sides of a plate: each path keeps to the side that it came from.
TEST_F(MeshPath, KeepsAHistoryForEachPath) {
    const double thick = 1e-5;
    const glm::dvec3 down{0, 0, -thick}, e = kA + down, f = kB + down, g = kC + down, h = kD + down;
    const std::vector<Polygon> plate{{kA, kB, kC, kD}, {h, g, f, e},   {kA, e, f, kB},
                                     {kB, f, g, kC},   {kC, g, h, kD}, {kD, h, e, kA}};
    std::string above = row(1, {0, 0, 0.001}), below = row(2, {0, 0, -0.001}), both = above + below;
    for (int i = 0; i < 500; ++i) {
        const glm::dvec3 probe{i * 1e-5, 0, 0.002 * std::sin(i * 0.1)};
        const std::string rows[]{row(1, probe), row(2, probe)};
        above += rows[0];
        below += rows[1];
        both += rows[0] + rows[1];
    }
    const std::string plates = scene(plate);
    const auto rows = rows_of(felt(prepare(plates), "path,t,x,y,z\n" + both));
    const auto apart = {rows_of(felt(prepare(plates), "path,t,x,y,z\n" + above)),
                        rows_of(felt(prepare(plates), "path,t,x,y,z\n" + below))};
    ASSERT_EQ(rows.size(), 1002u);
    for (std::size_t i = 0; i < rows.size(); ++i)
        EXPECT_EQ(rows[i], (apart.begin() + i % 2)->at(i / 2));
    for (std::size_t i = 2; i < rows.size(); i += 2) {
        const double z = number_in<double>(rows[i][4]);
        EXPECT_NEAR(number_in<double>(rows[i][10]), kStiffness * std::max(0.0, -z), 1e-13);
        EXPECT_NEAR(number_in<double>(rows[i + 1][10]), -kStiffness * std::max(0.0, z + thick), 1e-13);
    }
}

} // namespace
} // namespace forceshade::testing
