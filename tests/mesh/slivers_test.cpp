// Slivers reach no further than they are, in single precision too, where rounding takes away or turns their area.
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "host/mesh/structure.h"
#include "host/reference/mesh_nearest.h"
#include "tests/mesh/shapes.h"

namespace forceshade {
namespace {

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
