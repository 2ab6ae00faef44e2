// Numbers of paths made of their metrics, and the table of them.
#include <cmath>
#include <fstream>
#include <sstream>

#include <gtest/gtest.h>

#include "host/paths/explore.h"
#include "host/paths/path_files.h"
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

TEST(PathFigures, turns_are_angles_and_sums_keep_their_rests) {
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

TEST(PathFigures, a_turn_about_is_180_degrees) {
    layout::PathMetrics<float> metrics = reference::no_metrics<float>();
    metrics.largest_turn = std::nextafter(4.f, 5.f);
    EXPECT_EQ(figures_of(metrics, {1, 1000}).largest_turn, 180);
}

TEST(PathFigures, of_a_path_that_left_count_up_to_then) {
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

TEST(PathFigures, of_a_recorded_path_follow_the_times_of_its_samples) {
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

TEST(PathSummary, leaves_cells_empty_that_have_no_meaning) {
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
    std::ifstream file(folder / "a.paths.csv");
    std::ostringstream text;
    text << file.rdbuf();
    EXPECT_EQ(text.str(), std::string(path_summary_header()) +
                              "7,3,0,0,0,0,0,0,0,,0,,,,,,,,0,,0,,0,0\n"
                              "8,3,0,0.1,0,0,0,0,0,0.25,2,-1,0.5,2,,,,,1,1700000000.125,1,,0,0\n");
}

} // namespace
} // namespace forceshade::testing
