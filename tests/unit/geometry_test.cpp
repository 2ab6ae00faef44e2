// G1 and G2: the table of the paper's three cylinders, and facets that cover the bump.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/field/tables.h"
#include "host/reference/elementary.h"
#include "host/reference/surfaces.h"
#include "tests/unit/laws.h"

namespace forceshade::test {
namespace {

constexpr double kDegrees = 180 / std::numbers::pi;

double slope_degrees(const Scene& scene, double x) {
    const OwnedLaw<double> law(scene);
    const auto force = law(x, 0, -0.001).force;
    return std::atan2(std::abs(force.x), force.z) * kDegrees;
}

TEST(Geometry, TableOfTheThreeCylinders) {
    struct Row {
        double height_mm, angle, two_facets, three_arc, three_x;
    };
    const Row rows[] = {
        {6.816, 56.44, 28.22, 37.63, 36.29}, {3.403, 30.00, 15.00, 20.00, 19.80}, {2.345, 20.92, 10.46, 13.95, 13.88}};
    for (int i = 0; i < 3; ++i) {
        const double radius = kRadii[i];
        const double axis = std::sqrt((radius - kHalfWidth) * (radius + kHalfWidth));
        const double height = reference::cylinder_height(kHalfWidth, radius, axis, 0.0);
        EXPECT_NEAR(height * 1e3, rows[i].height_mm, 5e-4);
        const auto exact = static_cast<double>(
            (long double)radius - std::sqrt((long double)radius * radius - (long double)kHalfWidth * kHalfWidth));
        EXPECT_NEAR(height / exact, 1, 1e-12);
        const double angle = std::asin(kHalfWidth / radius);
        EXPECT_NEAR(angle * kDegrees, rows[i].angle, 5e-3);
        EXPECT_NEAR(slope_degrees(bump(radius, 2), 0.9 * kHalfWidth), rows[i].two_facets, 5e-3);
        EXPECT_NEAR(slope_degrees(bump(radius, 2), 0.9 * kHalfWidth), angle / 2 * kDegrees, 1e-9 * angle * kDegrees);
        EXPECT_NEAR(slope_degrees(bump(radius, 3), 0.9 * kHalfWidth), rows[i].three_arc, 5e-3);
        EXPECT_NEAR(slope_degrees(bump(radius, 3), 0.9 * kHalfWidth), angle * 2 / 3 * kDegrees,
                    1e-9 * angle * kDegrees);
        Scene equal_x = bump(radius, 3);
        equal_x.surface.facet_spacing = FacetSpacing::equal_x;
        EXPECT_NEAR(slope_degrees(equal_x, 0.9 * kHalfWidth), rows[i].three_x, 5e-3);
    }
}

TEST(Geometry, NormalIsTheCirclesNormal) {
    for (const double radius : kRadii)
        for (const double x : {-0.999, -0.5, 0.0, 0.3, 0.999}) {
            const auto normal = reference::reference_normal(radius, x * kHalfWidth, true);
            const double angle = std::asin(x * kHalfWidth / radius);
            EXPECT_NEAR(normal.x, std::sin(angle), 1e-15);
            EXPECT_NEAR(normal.z, std::cos(angle), 1e-15);
        }
}

template <typename T> void expect_vertices_cover(std::uint32_t facets, double radius, FacetSpacing spacing) {
    const std::vector<T> vertices = facet_vertices<T>(facets, kHalfWidth, radius, spacing);
    ASSERT_EQ(vertices.size(), std::size_t(facets) + 1);
    EXPECT_EQ(vertices.front(), static_cast<T>(-kHalfWidth));
    EXPECT_EQ(vertices.back(), static_cast<T>(kHalfWidth));
    for (std::size_t i = 0; i < facets; ++i) {
        ASSERT_LE(vertices[i], vertices[i + 1]) << i;
        ASSERT_EQ(vertices[i], -vertices[facets - i]) << i;
    }
}

TEST(Geometry, VerticesCoverTheBumpSymmetrically) {
    for (const std::uint32_t facets : {1u, 2u, 3u, 4u, 7u, 64u, 1000u, 999999u, 1000000u})
        for (const double radius : {kHalfWidth, kRadii[0], kRadii[2], 1e9 * kHalfWidth})
            for (const FacetSpacing spacing : {FacetSpacing::equal_arc, FacetSpacing::equal_x}) {
                expect_vertices_cover<float>(facets, radius, spacing);
                expect_vertices_cover<double>(facets, radius, spacing);
            }
}

TEST(Geometry, BisectionFindsTheFacetThatALoopFinds) {
    for (const std::uint32_t facets : {1u, 2u, 3u, 5u, 16u, 257u}) {
        const auto vertices = facet_vertices<float>(facets, kHalfWidth, kRadii[0], FacetSpacing::equal_arc);
        std::vector<float> places(vertices.begin(), vertices.end() - 1); // exactly on the boundaries
        for (const float vertex : vertices) {
            places.push_back(std::nextafter(vertex, 0.0f));
            places.push_back(0.37f * vertex);
        }
        for (const float x : places) {
            if (!(x >= vertices.front() && x < vertices.back()))
                continue;
            std::uint32_t expected = 0;
            while (!(vertices[expected] <= x && x < vertices[expected + 1]))
                ++expected;
            EXPECT_EQ(reference::facet_index<float>(vertices, x, facets), expected) << facets << " facets, x = " << x;
        }
    }
}

TEST(Geometry, FacetsApproachTheCircle) {
    // The largest gap between chord and arc falls fourfold as n doubles.
    const auto gap = [](std::uint32_t facets) {
        const OwnedLaw<double> law(bump(kRadii[0], facets));
        const double axis = std::sqrt((kRadii[0] - kHalfWidth) * (kRadii[0] + kHalfWidth));
        double largest = 0;
        for (int i = -999; i < 1000; ++i) {
            const double x = kHalfWidth * i / 1000;
            const double arc = reference::cylinder_height(kHalfWidth, kRadii[0], axis, x);
            largest = std::max(largest, arc - reference::column_at(law.tables.law(), x, 0.0).facet.height);
        }
        return largest;
    };
    EXPECT_NEAR(gap(16) / gap(32), 4, 0.2);
    EXPECT_NEAR(gap(32) / gap(64), 4, 0.2);
    EXPECT_LT(gap(1000000), 2e-14); // R dtheta^2 / 8 is 7e-15 m
}

} // namespace
} // namespace forceshade::test
