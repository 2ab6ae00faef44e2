// Numbers of paths made of their metrics, the table of them, and what a picture of paths says.
#include <cmath>
#include <numbers>

#include <gtest/gtest.h>

#include "host/paths/path_files.h"
#include "host/paths/recorded.h"
#include "host/reference/path_step.h"
#include "tests/io/folder.h"

namespace forceshade::testing {
namespace {

using reference::Vector;

reference::Contact<double> contact_at(double depth) {
    reference::Contact<double> contact{};
    contact.depth = depth;
    contact.facet = 0;
    return contact;
}

TEST(PathFigures, TurnsAreAnglesAndSumsKeepTheirRests) {
    layout::PathMetrics<double> metrics = reference::no_metrics<double>();
    const Vector<double> up{0, 0, 2};
    for (const double depth : {0.001, 0.003})
        reference::add_sample(metrics, contact_at(depth), up);
    metrics.largest_turn = metrics.steepest_turn = 2;
    metrics.steepest_distance = 1e-6;
    reference::add_work(metrics, 0.5);
    reference::add_work(metrics, -0.25);
    const PathFigures figures = figures_of(metrics, {4, 10, false, true});
    EXPECT_NEAR(figures.largest_turn, 90, 1e-12);
    EXPECT_NEAR(figures.steepest_turn, 90, 1e-12) << "over a millimetre";
    EXPECT_EQ(figures.largest_force, 2);
    EXPECT_NEAR(figures.rms_force, std::sqrt(8.0 / 4), 1e-15) << "over all samples of the path";
    EXPECT_EQ(figures.contact_time, 0.2);
    EXPECT_EQ(figures.work, 0.25);
    EXPECT_EQ(figures.effort, 0.75);
    EXPECT_NEAR(*figures.eta, 1.0 / 3, 1e-15);
    EXPECT_EQ(*figures.least_depth, 0.001);
    EXPECT_NEAR(*figures.mean_depth, 0.002, 1e-15);
    EXPECT_NEAR(*figures.depth_deviation, 0.001, 1e-12);
    EXPECT_FALSE(figures.unstable_time);
    EXPECT_FALSE(figures.speed_ratio);
    EXPECT_TRUE(figures.began_inside);
}

// A micrometre back and forth 7 mm deep: the difference of two squares of single precision would be 1.2 um for a probe
// that stands still.
TEST(PathFigures, OfAProbeThatHardlyMovesKeepItsDeviation) {
    for (const double swing : {0.0, 1e-6}) {
        layout::PathMetrics<float> metrics = reference::no_metrics<float>();
        double sum = 0;
        for (int i = 0; i < 10000; ++i) {
            reference::Contact<float> contact{};
            contact.facet = 0;
            contact.depth = float(i % 2 == 0 ? 7.3e-3 : 7.3e-3 + swing);
            sum += double(contact.depth);
            reference::add_sample(metrics, contact, Vector<float>(0, 0, 7.3F));
        }
        const PathFigures figures = figures_of(metrics, {10000, 1000});
        EXPECT_NEAR(*figures.depth_deviation, swing / 2, 1e-9);
        EXPECT_NEAR(*figures.mean_depth, sum / 10000, 1e-12);
    }
}

TEST(PathFigures, ATurnAboutIs180Degrees) {
    layout::PathMetrics<float> metrics = reference::no_metrics<float>();
    metrics.largest_turn = std::nextafter(4.f, 5.f);
    EXPECT_EQ(figures_of(metrics, {1, 1000}).largest_turn, 180);
}

TEST(PathFigures, OfAPathThatLeftCountUpToThen) {
    layout::PathMetrics<double> metrics = reference::no_metrics<double>();
    metrics.force_square = 8;
    metrics.unstable_step = 2;
    metrics.early_speed = 2;
    metrics.late_speed = 6;
    PathFigures figures = figures_of(metrics, {1000, 1000, true});
    EXPECT_EQ(figures.rms_force, 2);
    EXPECT_EQ(*figures.unstable_time, 0.002);
    EXPECT_EQ(*figures.speed_ratio, 3);
    metrics.unstable_step = 0;
    figures = figures_of(metrics, {1000, 1000, true});
    EXPECT_EQ(figures.rms_force, 0) << "no sample, and no 0 / 0";
    EXPECT_EQ(*figures.unstable_time, 0);
}

TEST(PathFigures, OfARecordedPathFollowTheTimesOfItsSamples) {
    ContactTime contact;
    EXPECT_EQ(contact.total(), 0);
    contact.add(10, true);
    EXPECT_EQ(contact.total(), 0) << "one sample has no time";
    contact.add(10.5, false);
    EXPECT_EQ(contact.total(), 0.5);
    contact.add(11, true);
    EXPECT_EQ(contact.total(), 1) << "the last one counts as much as the one before it";
    contact.add(15, true);
    EXPECT_EQ(contact.total(), 0.5 + 4 + 4);
    layout::PathMetrics<float> metrics = reference::no_metrics<float>();
    metrics.contact_samples = 3;
    metrics.unstable_step = 3;
    const PathFigures figures = figures_of(metrics, {4, 1000, true, false, PathTimes{contact.total(), 15}});
    EXPECT_EQ(figures.contact_time, 8.5);
    EXPECT_EQ(figures.unstable_time, 15);
}

TEST(PathSummary, LeavesCellsEmptyThatHaveNoMeaning) {
    Folder folder;
    PathSummary summary(folder / "a.paths.csv", Precision::f32);
    PathFigures figures = figures_of(reference::no_metrics<float>(), {3, 1000});
    summary.add(7, figures);
    figures.largest_force = double(0.1f);
    figures.eta = 0.25;
    figures.rounds = 2;
    figures.least_round = -1;
    figures.mean_round = 0.5;
    figures.largest_round = 2;
    figures.unstable_time = 1700000000.125; // a clock's, which a float does not hold
    figures.fell = true;
    summary.add(8, figures);
    summary.finish();
    EXPECT_EQ(folder.read("a.paths.csv"), std::string(path_summary_header()) +
                                              "7,3,0,0,0,0,0,0,0,,0,,,,,,,,0,,0,,0,0\n"
                                              "8,3,0,0.1,0,0,0,0,0,0.25,2,-1,0.5,2,,,,,1,1700000000.125,1,,0,0\n");
}

TEST(PathPicture, TellsHowCloselyPathsFollowALine) {
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

TEST(PathPicture, ShowsAHandfulOfPathsOfMany) {
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

// Path i lies at z = i mm and its force is turned by i / 10 deg; the last tenth of it has no force.
TEST(PathPicture, HasAllPathsInItsBands) {
    constexpr std::size_t kPaths = 101, kSteps = 200;
    PathCollector collector(kPaths, kSteps), few(5, kSteps);
    const std::vector<layout::uint> steps(kPaths, kSteps);
    std::vector<float> position, force;
    for (std::size_t path = 0; path < kPaths; ++path)
        for (std::size_t step = 0; step < kSteps; ++step) {
            const double angle = double(path) / 10 * std::numbers::pi / 180, size = step < 180 ? 1 : 0;
            position.insert(position.end(), {float(step), 0, 1e-3F * float(path)});
            force.insert(force.end(), {float(size * std::sin(angle)), 0, float(size * std::cos(angle))});
        }
    collector.add(PathRows<float>{0, kPaths, kSteps, steps, position, force, {}, {}, {}});
    few.add(PathRows<float>{0, 5, kSteps, steps, position, force, {}, {}, {}});
    const std::vector<picture::PathBand> bands = collector.bands();
    ASSERT_FALSE(bands.empty());
    for (const picture::PathBand& band : bands)
        for (const auto& [i, path] : {std::pair{0, 5.0}, {1, 50.0}, {2, 95.0}}) {
            const auto at = static_cast<std::size_t>(i);
            EXPECT_NEAR(band.z[at], 1e-3 * path, 1.1e-3) << band.x;
            if (band.x < 178) {
                EXPECT_NEAR(band.direction[at], path / 10, 0.11) << band.x;
            } else if (band.x > 182) {
                EXPECT_TRUE(std::isnan(band.direction[at])) << band.x;
            }
        }
    EXPECT_TRUE(few.bands().empty()) << "all of them are drawn";
}

TEST(PathPicture, IsTheSameOfAPathInPieces) {
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
