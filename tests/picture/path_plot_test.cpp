// The picture of explored paths: normals of lines, texts that keep clear of each other, the same bytes.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host/field/prepared_case.h"
#include "host/picture/canvas.h"
#include "host/picture/picture.h"
#include "host/scene/cases.h"
#include "tests/picture/cases.h"

namespace forceshade::picture::test {
namespace {

PathDrawing sample() {
    PathDrawing drawing{{"Bump of 3 facets"}, {"2 of 2 paths"}, {}, {{{-0.02, 0}, {0, 0.002}, {0.02, 0}}, {}}, true};
    for (int p = 0; p < 2; ++p) {
        DrawnPath path;
        path.label = "path " + std::to_string(p);
        for (int i = 0; i <= 100; ++i) {
            path.way.push_back({-0.015 + i * 3e-4, 0.001 * p});
            path.direction.push_back(i % 10 == 9 ? std::numeric_limits<double>::quiet_NaN() : 5.0 - i * 0.1);
        }
        drawing.paths.push_back(path);
    }
    return drawing;
}

TEST(PathPlot, NormalsLeanAwayFromTheSlope) {
    const std::vector<LinePoint> normals = normals_of({{0, 0}, {1, 1}, {2, 1}, {3, 0}});
    ASSERT_EQ(normals.size(), 6u);
    EXPECT_NEAR(normals[0].z, -45, 1e-12) << "uphill to the right: the normal points to the left";
    EXPECT_EQ(normals[1].x, 1);
    EXPECT_EQ(normals[2].z, 0);
    EXPECT_NEAR(normals[5].z, 45, 1e-12);
    EXPECT_TRUE(normals_of({{0, 0}}).empty());
}

TEST(PathPlot, ShowsTheSurfaceAboutPathsThatAreHardlyWide) {
    DrawnPath tap{"tap", {{0.003, 0.001}, {0.003, -0.001}}, {}};
    EXPECT_NEAR(drawn_breadth({tap}).low, 0.002, 1e-15);
    EXPECT_NEAR(drawn_breadth({tap}).high, 0.004, 1e-15);
    DrawnPath still{"still", {{0.003, 0.001}}, {}};
    EXPECT_NEAR(drawn_breadth({still}).high - drawn_breadth({still}).low, 0.002, 1e-15);
    DrawnPath stroke{"stroke", {{-0.01, 0.001}, {0.02, -0.001}}, {}};
    EXPECT_EQ(drawn_breadth({stroke}).low, -0.01) << "wide enough by itself";
    EXPECT_EQ(drawn_breadth({stroke}).high, 0.02);
}

TEST(PathPlot, IsTheSameEveryTimeAndItsTextsAreOnTheSheet) {
    const Picture one = draw_paths(sample()), other = draw_paths(sample());
    EXPECT_EQ(one.png, other.png);
    EXPECT_GT(one.texts.size(), 15u);
    expect_clear_texts(one);
}

TEST(PathPlot, OfAPathThatStandsStillIsDrawn) {
    PathDrawing drawing = sample();
    drawing.paths.resize(1);
    drawing.paths[0].way = {{0.001, 0.002}};
    drawing.paths[0].direction = {std::numeric_limits<double>::quiet_NaN()};
    EXPECT_GT(draw_paths(drawing).png.size(), 1000u);
    drawing.surface = {};
    EXPECT_GT(draw_paths(drawing).png.size(), 1000u);
}

// The paper's bump of two facets, in closed form: with shading the force turns as the cylinder's normal does.
TEST(Stroke, OfABumpIsTheClosedForm) {
    constexpr double kHalfOfBump = 12.7e-3, kOfCylinder = 15.24e-3, kStiffness = 1000, kDepth = 1e-3;
    const PreparedCase prepared = CasePreparation().prepare(
        parse_scene("[surface]\nkind = \"bump\"\nradius = \"600 mil\"\nfacets = 2\n[force]\nstiffness = \"1 N/mm\"\n"
                    "shading = \"reference\"\n",
                    "scene"));
    const SceneStroke stroke = stroke_of(prepared, 0);
    EXPECT_EQ(stroke.depth, kDepth);
    const double slope =
        std::atan2(kOfCylinder - std::sqrt(kOfCylinder * kOfCylinder - kHalfOfBump * kHalfOfBump), kHalfOfBump);
    std::size_t on_bump = 0;
    for (const StrokedForce& one : stroke.forces) {
        if (std::abs(std::abs(one.x) - kHalfOfBump) < 1e-6 || std::abs(one.x) < 1e-6)
            continue;
        const bool flat = std::abs(one.x) > kHalfOfBump;
        const double size = kStiffness * kDepth, tilt = flat ? 0 : std::copysign(slope, one.x),
                     turn = flat ? 0 : std::asin(one.x / kOfCylinder);
        on_bump += flat ? 0 : 1;
        EXPECT_NEAR(one.unshaded[0], size * std::sin(tilt), 1e-9) << one.x;
        EXPECT_NEAR(one.unshaded[2], size * std::cos(tilt), 1e-9) << one.x;
        EXPECT_NEAR(one.force[0], size * std::sin(turn), 1e-9) << one.x;
        EXPECT_NEAR(one.force[2], size * std::cos(turn), 1e-9) << one.x;
    }
    EXPECT_GT(on_bump, 400u);
    expect_clear_texts(draw_stroke({"A bump"}, {}, stroke.forces, true));
    expect_clear_texts(draw_stroke({"A bump", 700}, {}, {stroke.forces.data(), 1}, false));
}

} // namespace
} // namespace forceshade::picture::test
