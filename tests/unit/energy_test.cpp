// Work round closed loops: which fields are conservative, and how much the others give.
#include <cmath>

#include <gtest/gtest.h>

#include "tests/unit/closed_forms.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

using Corners = std::vector<study::Vector>;

study::Work round(const OwnedLaw<double>& law, const Corners& corners) {
    return study::work_round(force_of(law), corners);
}

// Out along x at depth d1, up, back at d2, down: the rectangle of the energy formula.
Corners rectangle(double x, double d1, double d2) {
    return {{0, 0, -d1}, {x, 0, -d1}, {x, 0, -d2}, {0, 0, -d2}};
}

constexpr double kStiffness = 500;                                  /* N/m */
constexpr double kD1 = 0.002, kD2 = 0.001, kX = 0.999 * kHalfWidth; /* m */

double closed_form(double radius) {
    return study::shaded_plane_work({kStiffness, radius, kX, kD1, kD2});
}

TEST(Energy, CylinderOnPlaneIsConservative) {
    for (const double radius : kRadii) {
        const OwnedLaw<double> law(cylinder_bump(radius));
        // Within both solids, where the force is smooth.
        const study::Work inside =
            round(law, {{-0.004, 0, -0.003}, {0.005, 0, -0.002}, {0.003, 0, -0.0005}, {-0.002, 0, -0.001}});
        EXPECT_LT(std::abs(inside.work), 1e-12 * inside.effort);
        // Half above the plane: the corners lie on z = 0, so that no piece has a kink.
        const study::Work across = round(law, {{-0.004, 0, -0.002},
                                               {0.004, 0, -0.002},
                                               {0.004, 0, 0},
                                               {0.002, 0, 0.001},
                                               {-0.002, 0, 0.001},
                                               {-0.004, 0, 0}});
        EXPECT_LT(std::abs(across.work), 1e-9 * across.effort);
    }
}

TEST(Energy, ShadedPlaneGivesTheClosedForm) {
    const double printed_mJ[] = {2.3061, 1.4841, 1.0823};
    for (int i = 0; i < 3; ++i) {
        Scene scene = bump(kRadii[i], 1, Shading::reference);
        scene.force.stiffness = kStiffness;
        const study::Work loop = round(OwnedLaw<double>(scene), rectangle(kX, kD1, kD2));
        EXPECT_NEAR(loop.work * 1e3, printed_mJ[i], 5e-5);
        EXPECT_NEAR(loop.work / closed_form(kRadii[i]), 1, 1e-9);
    }
}

// Out along the polygon at depth d1, back at d2, over the middle vertex of four facets.
TEST(Energy, EachBreakOfUnshadedFacetsGives) {
    for (const DepthReading depth : {DepthReading::vertical, DepthReading::normal}) {
        Scene scene = bump(kRadii[0], 4);
        scene.force.stiffness = kStiffness;
        scene.force.depth = depth;
        const OwnedLaw<double> law(scene);
        const double vertex = law.tables.facet_vertices[3], left = vertex - 0.002, right = vertex + 0.002;
        const auto facet = [&](double x) { return reference::column_at(law.tables.law(), x, 0.0).facet; };
        const auto below = [&](double x, double d) { return study::Vector(x, 0, facet(x).height - d); };
        // Lines stop short of the vertex by nothing: the facet right of it begins at the vertex itself.
        const auto work = [&](double x1, double depth1, double x2, double depth2) {
            return study::work_along(force_of(law), below(x1, depth1), below(x2, depth2)).work;
        };
        double sum = 0;
        const double before = std::nextafter(vertex, 0.0);
        sum += work(left, kD1, before, kD1) + work(vertex, kD1, right, kD1);
        sum += work(right, kD1, right, kD2);
        sum += work(right, kD2, vertex, kD2) + work(before, kD2, left, kD2);
        sum += work(left, kD2, left, kD1);
        const double power = depth == DepthReading::vertical ? 1 : 2;
        const double gain = std::pow(facet(right).normal_z, power) - std::pow(facet(left).normal_z, power);
        // At constant vertical depth the normal reading's d^2 shrinks by one more cosine, which the exponent holds.
        EXPECT_NEAR(sum, 0.5 * kStiffness * gain * (kD1 * kD1 - kD2 * kD2), 1e-9 * std::abs(sum) + 1e-15);
        EXPECT_GT(std::abs(sum), 1e-6);
    }
}

} // namespace
} // namespace forceshade::test
