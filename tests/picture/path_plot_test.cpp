// The picture of explored paths: normals of lines, texts that keep clear of each other, the same bytes.
#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host/picture/canvas.h"
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

} // namespace
} // namespace forceshade::picture::test
