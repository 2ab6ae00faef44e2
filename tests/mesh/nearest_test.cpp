// The nearest point of a mesh through its tree, held against a loop over all triangles in the same precision, bit for
// bit; and slivers, which reach no further than they are.
#include <algorithm>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "tests/mesh/shapes.h"
#include "tests/mesh/structure_check.h"

namespace forceshade {
namespace {

using reference::Nearest;
using reference::Vector;
using shapes::same;

template <typename T> struct Probes {
    std::mt19937 random{7};
    const MeshTables<T> tables;
    std::vector<Vector<T>> all;

    double uniform() { return shapes::uniform(random); }
    Vector<T> within(double reach) { return Vector<T>(shapes::anywhere(random, reach)); }

    Probes(const MeshStructure& structure, int count) : tables(make_mesh_tables<T>(structure, 1000)) {
        const layout::MeshView<T> mesh = tables.view();
        for (int i = 0; i < count; ++i) {
            all.push_back(within(1.2));
            all.push_back(within(std::pow(10.0, 6 * std::abs(uniform()))));
            // On corners, edges and faces, and hardly beside them.
            const std::size_t triangle = random() % mesh.params.triangles;
            Vector<T> corners[3];
            for (std::size_t j = 0; j < 3; ++j)
                corners[j] = reference::vector_at(mesh.vertices, mesh.triangle_corners[3 * triangle + j]);
            const T u = T(std::abs(uniform())), v = T(std::abs(uniform())) * (T(1) - u);
            all.push_back(corners[0]);
            all.push_back(corners[0] + u * (corners[1] - corners[0]));
            const Vector<T> on = corners[0] + u * (corners[1] - corners[0]) + v * (corners[2] - corners[0]);
            all.push_back(on);
            all.push_back(on + within(1e-3));
            all.push_back(on + within(double(std::numeric_limits<T>::epsilon())));
        }
        // Equally far from much: the middle, planes and axes of symmetry.
        all.push_back({});
        for (int i = 0; i < count / 4; ++i) {
            const T s = T(uniform()), t = T(uniform());
            for (const Vector<T>& probe : {Vector<T>(s, 0, 0), Vector<T>(s, s, s), Vector<T>(s, t, 0),
                                           Vector<T>(s, s, t), Vector<T>(t, s, s), Vector<T>(0, s, -s)})
                all.push_back(probe);
        }
    }
};

template <typename T> void hold_against_loop(const PolygonSoup& polygons, int count) {
    const Probes<T> probes(build_structure(shapes::mesh_of(polygons)), count);
    const layout::MeshView<T> mesh = probes.tables.view();
    layout::uint hint = 0;
    for (const Vector<T>& probe : probes.all) {
        const Nearest<T> expected = shapes::nearest_by_loop(mesh, probe);
        const Nearest<T> found = reference::nearest(mesh, probe);
        ASSERT_TRUE(same(found, expected))
            << probe.x << ' ' << probe.y << ' ' << probe.z << ": triangle " << found.triangle << " at " << found.square
            << ", not " << expected.triangle << " at " << expected.square;
        ASSERT_TRUE(same(reference::nearest(mesh, probe, hint), expected));
        ASSERT_TRUE(std::isfinite(found.square));
        hint = found.triangle;
    }
}

// In single precision two of its corners are one, and its normal is not across the edge that is left: its face must not
// be met beside it.
TEST(Nearest, ATriangleThatRoundingMakesALineHasNoFace) {
    const PolygonSoup polygons = shapes::soup_of({{0.5, 0.25, -1e-11},
                                                  {0.5 + 2e-11, 0.25 + 1e-12, 1e-11},
                                                  {0.5, 0.25 + 1e-12, -1e-11},
                                                  {-1, -1, -1},
                                                  {-1, -1, 1},
                                                  {-1, 1, 1},
                                                  {1, 1, 1}}, // for the frame
                                                 {{0, 1, 2}, {3, 4, 5}, {4, 6, 5}});
    const auto tables = make_mesh_tables<float>(build_structure(shapes::mesh_of(polygons)), 1000);
    const Vector<float> probe(1.25f, 0.25f, 0);
    const Nearest<float> found = shapes::nearest_by_loop(tables.view(), probe);
    EXPECT_NEAR(found.square, 0.5625f, 1e-6f);
    EXPECT_TRUE(same(reference::nearest(tables.view(), probe), found));
}

class NearestOn : public ::testing::TestWithParam<std::pair<const char*, PolygonSoup (*)()>> {};

TEST_P(NearestOn, EqualsLoopInDouble) {
    hold_against_loop<double>(GetParam().second(), 60);
}

TEST_P(NearestOn, EqualsLoopInSingle) {
    hold_against_loop<float>(GetParam().second(), 60);
}

INSTANTIATE_TEST_SUITE_P(
    Shapes, NearestOn,
    ::testing::Values(
        std::pair{"icosphere", +[] { return shapes::icosphere(4); }},
        std::pair{"cube", +[] { return shapes::cube(true); }},
        std::pair{"finely_cut_cube",
                  +[] { return shapes::subdivided(shapes::subdivided(shapes::subdivided(shapes::cube()))); }},
        std::pair{"polyhedra", +[] { return shapes::random_polyhedra(500, 3); }},
        std::pair{"needles", +[] { return shapes::needle_fan(1000, 50); }},
        std::pair{"flat_needles", +[] { return shapes::needle_fan(1000, 1e-6); }},
        std::pair{"slivers", +[] { return shapes::sliver_box(200, 1e8); }},
        std::pair{"plate", +[] { return shapes::plate(1e-5); }},
        std::pair{"shells", +[] { return shapes::nested_shells(3, true); }},
        std::pair{"triangle", +[] { return shapes::single_triangle(); }},
        std::pair{"far_away", +[] { return shapes::moved(shapes::icosphere(3), glm::dvec3(1), glm::dvec3(1e6)); }},
        std::pair{"twice",
                  +[] { // the second time turned over, or it would count for nothing
                      PolygonSoup over = shapes::icosphere(3);
                      std::reverse(over.corners.begin(), over.corners.end());
                      return shapes::merged(shapes::icosphere(3), over);
                  }}),
    [](const auto& parameter) { return std::string(parameter.param.first); });

TEST(Slivers, InSinglePrecisionReachNoFurtherThanTheyAre) {
    // Rounded to single precision such triangles have no area, or a wrong one.
    const MeshStructure structure = build_structure(shapes::mesh_of(shapes::sliver_box(200, 1e8)));
    const MeshTables<float> tables = make_mesh_tables<float>(structure, 1);
    const layout::MeshView<float> view = tables.view();
    std::mt19937 random(3);
    for (int i = 0; i < 2000; ++i) {
        const reference::Vector<double> probe(3 * shapes::uniform(random), shapes::uniform(random),
                                              2 * shapes::uniform(random));
        const double exact = std::sqrt(reference::nearest(make_mesh_tables<double>(structure, 1).view(), probe).square);
        const float found = std::sqrt(reference::nearest(view, reference::Vector<float>(probe)).square);
        EXPECT_NEAR(found, exact, 1e-6);
    }
}

TEST(Slivers, TipsOfSliversDoNotReachBeyondThemselves) {
    std::mt19937 random(4);
    for (int i = 0; i < 20000; ++i) {
        // A needle in a random direction, and a probe hardly off its line beyond the tip.
        const glm::dvec3 way = reference::normalised(
            glm::dvec3(shapes::uniform(random), shapes::uniform(random), shapes::uniform(random)));
        const glm::dvec3 other = reference::normalised(
            reference::cross(way, glm::dvec3(shapes::uniform(random), shapes::uniform(random), 1)));
        const double width = std::pow(10, -6 - 3 * std::abs(shapes::uniform(random)));
        const glm::dvec3 tip(0.0), left = -way + width * other, right = -way - width * other;
        const glm::dvec3 normal = reference::normalised(reference::cross(other, way)); // of tip, left, right
        const double beyond = 0.01 + std::abs(shapes::uniform(random));
        const glm::dvec3 probe = beyond * way + 1e-3 * normal;
        const auto expect_beyond = [&](const auto& point, double tolerance) {
            EXPECT_NEAR(std::sqrt(double(point.square)), std::hypot(beyond, 1e-3), tolerance);
        };
        using Single = reference::Vector<float>;
        expect_beyond(reference::nearest_on_triangle(probe, tip, left, right, normal), 1e-12);
        expect_beyond(
            reference::nearest_on_triangle(Single(probe), Single(tip), Single(left), Single(right), Single(normal)),
            1e-5);
        // At the other end, the short edge.
        const glm::dvec3 behind = -(1 + beyond) * way + 1e-3 * normal;
        expect_beyond(reference::nearest_on_triangle(behind, tip, left, right, normal), 1e-12);
        expect_beyond(
            reference::nearest_on_triangle(Single(behind), Single(tip), Single(left), Single(right), Single(normal)),
            1e-5);
    }
}

} // namespace
} // namespace forceshade
