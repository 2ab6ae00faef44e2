// G1 and G2: the table of the paper's three cylinders, facets that cover the bump; and what a scene switches on.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/field/prepared_case.h"
#include "host/reference/elementary.h"
#include "host/reference/surfaces.h"
#include "host/scene/study.h"
#include "tests/io/folder.h"
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

bool mentions(const std::vector<std::string>& omitted, const std::string& what) {
    return std::any_of(omitted.begin(), omitted.end(),
                       [&](const std::string& phrase) { return phrase.find(what) != std::string::npos; });
}

TEST(Tables, AFieldThatDoesNotDependOnYIsEvaluatedOnce) {
    Scene scene = bump(kRadii[0], 2);
    scene.grid.size = {8, 6, 4};
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 1u);
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::everything).y.size(), 6u);
    scene.output.channels = layout::kChannelForce | layout::kChannelProxy;
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 6u) << "a proxy has the probe's y";
    scene.output.channels = layout::kChannelForce;
    scene.texture = TextureSpec{100, {}};
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 1u) << "a cylinder does not depend on y";
    scene.texture->map.function = MapFunction::gaussian;
    EXPECT_EQ(make_tables<float>(scene, {}, Extent::what_varies).y.size(), 6u);
}

TEST(Tables, OnlyMapsInUseThatVaryAlongYMakeAFieldDependOnIt) {
    Scene scene = height_map({});
    scene.surface.map.function = MapFunction::gaussian;
    EXPECT_TRUE(depends_on_y(features_of(scene)));
    scene.force.shading = Shading::none;
    EXPECT_FALSE(depends_on_y(features_of(scene))) << "the map is not in use";
    scene.texture = TextureSpec{100, {}};
    scene.texture->map.function = MapFunction::sine;
    EXPECT_FALSE(depends_on_y(features_of(scene)));
    scene.texture->map.function = MapFunction::file;
    EXPECT_TRUE(depends_on_y(features_of(scene)));
    scene.texture->stiffness = 0;
    EXPECT_FALSE(depends_on_y(features_of(scene)));
}

TEST(Tables, AxesAreRoundedOnce) {
    Scene scene = bump(kRadii[0], 2);
    scene.grid.size = {1000, 1, 1};
    scene.grid.origin = {1000, 0, 0};
    scene.grid.spacing = {1e-4, 1e-4, 1e-4};
    const auto tables = make_tables<float>(scene, {}, Extent::everything);
    for (std::size_t i = 0; i < 1000; ++i)
        EXPECT_EQ(tables.x[i], static_cast<float>(1000 + 1e-4 * static_cast<double>(i)));
}

TEST(Tables, OnlyWhatTheSceneUsesIsSwitchedOn) {
    Scene scene = bump(kRadii[0], 2);
    scene.grid.size = {8, 6, 4};
    EXPECT_TRUE(mentions(omissions(scene), "shading"));
    EXPECT_TRUE(mentions(omissions(scene), "texture"));
    EXPECT_TRUE(mentions(omissions(scene), "5 of 6 y samples"));
    scene.field = false;
    EXPECT_FALSE(mentions(omissions(scene), "y samples")) << "paths alone have no samples of a grid";
    scene.field = true;
    scene.force.shading = Shading::reference;
    scene.texture = TextureSpec{100, {}};
    EXPECT_FALSE(mentions(omissions(scene), "shading"));
    EXPECT_FALSE(mentions(omissions(scene), "texture"));
    scene.texture->stiffness = 0;
    EXPECT_TRUE(mentions(omissions(scene), "texture")) << "a texture without stiffness is none";
    scene.force.reference = ReferenceDirection::radial;
    EXPECT_EQ(features_of(scene).reference, layout::kReferenceRadial);
    scene.force.shading = Shading::none;
    EXPECT_EQ(features_of(scene).reference, layout::kReferenceNormal) << "without shading no direction is borrowed";
    EXPECT_TRUE(make_tables<float>(height_map({}), {}, Extent::everything).facet_vertices.empty());
}

std::vector<std::string> scene_warnings(const std::string& toml) {
    return CasePreparation().prepare(parse_scene(toml, "scene")).warnings;
}

TEST(Warnings, OfAFinerGridThatLeavesOutAPartOfTheBump) {
    EXPECT_TRUE(scene_warnings("[surface]\nkind = \"bump\"\n").empty());
    EXPECT_TRUE(scene_warnings("[grid]\nspacing = \"0.1 mm\"\norigin = [\"0 mm\", \"0 mm\", \"0 mm\"]\n").empty());
    const auto found = scene_warnings("[grid]\nspacing = \"0.1 mm\"\n");
    ASSERT_EQ(found.size(), 1u);
    EXPECT_TRUE(mentions(found, "the grid ends at x = 0.5 mm, the bump at 12.7 mm")) << found.front();
}

TEST(Warnings, OfAMeshThatNoHandSpans) {
    const testing::Folder folder;
    const std::filesystem::path file =
        folder.write("tetrahedron.obj", "v 0 0 0\nv 40 0 0\nv 0 40 0\nv 0 0 40\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
    const std::string scene = "[surface]\nkind = \"mesh\"\nfile = \"" + file.string() + "\"\n";
    EXPECT_TRUE(scene_warnings(scene + "unit = \"mm\"\n[grid]\nsamples = 4\n").empty());
    EXPECT_TRUE(mentions(scene_warnings(scene + "[grid]\nsamples = 4\n"), "is 40 m across"));
}

} // namespace
} // namespace forceshade::test
