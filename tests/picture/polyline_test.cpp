#include "host/picture/frame.h"

#include <cmath>
#include <gtest/gtest.h>
#include <limits>

namespace forceshade::picture {
namespace {

constexpr Box kPlot{100, 100, 200, 100};

TEST(VisiblePieces, KeepsWhatIsInside) {
    const std::vector<Point> line{{120, 120}, {150, 180}, {290, 110}};
    const auto pieces = visible_pieces(line, kPlot);
    ASSERT_EQ(pieces.size(), 1U);
    ASSERT_EQ(pieces[0].size(), 3U);
    EXPECT_EQ(pieces[0][1].x, 150);
}

TEST(VisiblePieces, CutsFarAwayEndsAndDropsWhatIsOutside) {
    const auto pieces = visible_pieces(std::vector<Point>{{-1e18, 150}, {1e18, 150}}, kPlot);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_NEAR(pieces[0].front().x, 92, 200 /* pixels: 1e18 leaves few digits */);
    EXPECT_NEAR(pieces[0].back().x, 308, 200);
    EXPECT_TRUE(visible_pieces(std::vector<Point>{{0, 0}, {400, 0}}, kPlot).empty());
}

TEST(VisiblePieces, LeavesAndComesBackAsTwoPieces) {
    const std::vector<Point> line{{150, 150}, {150, 400}, {250, 400}, {250, 150}};
    EXPECT_EQ(visible_pieces(line, kPlot).size(), 2U);
}

TEST(VisiblePieces, BreaksAtWhatIsNoNumber) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const std::vector<Point> line{{110, 150}, {150, 150}, {nan, 150}, {200, 150}, {250, 150}};
    const auto pieces = visible_pieces(line, kPlot);
    ASSERT_EQ(pieces.size(), 2U);
    EXPECT_EQ(pieces[0].back().x, 150);
    EXPECT_EQ(pieces[1].front().x, 200);
}

TEST(VisiblePieces, ThinsOutAMillionPoints) {
    std::vector<Point> line(1'000'001);
    for (std::size_t i = 0; i < line.size(); ++i)
        line[i] = {100 + 200.0 * static_cast<double>(i) / 1e6, 150};
    const auto pieces = visible_pieces(line, kPlot);
    ASSERT_EQ(pieces.size(), 1U);
    EXPECT_LT(pieces[0].size(), 700U);
    EXPECT_EQ(pieces[0].back().x, 300);
}

TEST(SeenAsLine, MakesABarOfWhatStaysInOnePlace) {
    const std::vector<Point> bar = seen_as_line({{50, 20}, {50, 20}, {50.5, 20}});
    ASSERT_EQ(bar.size(), 2u);
    EXPECT_GT(bar[1].x - bar[0].x, 5);
    EXPECT_EQ(bar[0].y, 20);
    EXPECT_EQ(seen_as_line({{50, 20}, {60, 20}}).size(), 2u);
    EXPECT_EQ(seen_as_line({{50, 20}, {60, 20}})[0].x, 50) << "long enough by itself";
    EXPECT_TRUE(seen_as_line({}).empty());
}

} // namespace
} // namespace forceshade::picture
