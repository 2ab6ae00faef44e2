// What a picture of paths says of them: which are shown, how closely they follow a line.
#include <cmath>

#include <gtest/gtest.h>

#include "host/paths/path_files.h"

namespace forceshade::testing {
namespace {

TEST(PathPicture, tells_how_closely_paths_follow_a_line) {
    // A roof of 45 degrees; the path runs 1 above and 3 below it in turn, its force along the normal but for 2 degrees.
    const std::vector<picture::LinePoint> roof{{-2, 0}, {0, 2}, {2, 0}};
    picture::DrawnPath path;
    for (int i = 0; i < 100; ++i) {
        const double x = -1.98 + 0.04 * i;
        path.way.push_back({x, 2 - std::abs(x) + (i % 2 ? 1 : -3)});
        path.direction.push_back((x < 0 ? -45 : 45) + (i % 2 ? 2 : -2));
    }
    path.way.push_back({0, 100}); // out of contact
    path.direction.push_back(NAN);
    path.way.push_back({5, 0}); // beside the line
    path.direction.push_back(0);
    const Following f = following({path}, roof);
    EXPECT_EQ(f.samples, 100u);
    EXPECT_NEAR(f.sunk, 1, 1e-12);
    EXPECT_NEAR(f.distance, 2, 1e-12);
    EXPECT_NEAR(f.angle, 2, 1e-9);
    EXPECT_NEAR(f.median_angle, 2, 1e-9);
    EXPECT_EQ(following({path}, {{0, 0}, {0, 1}}).samples, 0u) << "no height can be read off that";
}

TEST(PathPicture, shows_a_handful_of_paths_of_many) {
    PathCollector collector(1000, 10);
    const std::vector<layout::uint> steps(100, 10);
    const std::vector<float> values(3 * 100 * 10, 0.5f);
    for (std::size_t first = 0; first < 1000; first += 100)
        collector.add(PathRows<float>{first, 100, 10, steps, values, values, {}, {}, {}});
    ASSERT_EQ(collector.paths().size(), 5u);
    EXPECT_EQ(collector.paths()[4].label, "path 800");
    EXPECT_EQ(collector.paths()[4].way.size(), 10u);
    EXPECT_EQ(collector.paths()[0].direction[3], 45);
    EXPECT_EQ(collector.reach().y, 0.5);
}

TEST(PathPicture, is_the_same_of_a_path_in_pieces) {
    constexpr std::size_t kLong = 100000; // every third sample is shown
    const std::vector<layout::uint> steps{kLong};
    std::vector<float> position(3 * kLong, 0.f), force(3 * kLong, 1.f);
    for (std::size_t i = 0; i < kLong; ++i)
        position[3 * i] = static_cast<float>(i);
    PathCollector whole(1, kLong), pieces(1, kLong);
    whole.add(PathRows<float>{0, 1, kLong, steps, position, force, {}, {}, {}});
    for (std::size_t first = 0, count = 0; first < kLong; first += count) {
        count = std::min<std::size_t>(7777, kLong - first);
        pieces.add(PathRows<float>{0,
                                   1,
                                   count,
                                   steps,
                                   std::span(position).subspan(3 * first),
                                   std::span(force).subspan(3 * first),
                                   {},
                                   {},
                                   {},
                                   first});
    }
    ASSERT_EQ(pieces.paths().size(), 1u);
    ASSERT_EQ(pieces.paths()[0].way.size(), whole.paths()[0].way.size());
    for (std::size_t i = 0; i < pieces.paths()[0].way.size(); ++i)
        EXPECT_EQ(pieces.paths()[0].way[i].x, whole.paths()[0].way[i].x);
}

} // namespace
} // namespace forceshade::testing
