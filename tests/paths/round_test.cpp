// The work done on the hand in each round of a motion, whose period is seldom a whole number of samples.
#include <cmath>
#include <fstream>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/paths/path_files.h"
#include "tests/io/folder.h"
#include "tests/paths/explored.h"

namespace forceshade {
namespace {

constexpr double kRoundStiffness = 500;                  // N/m
constexpr double kRadius = 5e-3, kHeight = 2e-3;         // m: of a Gaussian
constexpr double kRate = 1000;                           // Hz
constexpr std::array kAwkward{50.37, 61.618, 73.141592}; // samples a round

PathFigures figures(const std::string& paths, double period, double way, int rounds) {
    const auto result =
        explored<double>(fmt::format(R"(
[surface]
kind = "height_map"
function = "gaussian"
radius = "{} m"
height = "{} m"
[force]
stiffness = "{} N/m"
shading = "height_map"
[paths]
count = 1
steps = {}
speed = "{:.17g} m/s"
{}
)",
                                     kRadius, kHeight, kRoundStiffness,
                                     static_cast<int>(std::ceil(period * rounds)) + 1, way * kRate / period, paths),
                         {}, false);
    return figures_of(result.metrics.front(), {result.steps, kRate});
}

// The largest error of a round's work, J; 0: none was missed.
double error_of(const PathFigures& found, double exact, int rounds) {
    EXPECT_EQ(found.rounds, static_cast<std::uint64_t>(rounds));
    EXPECT_LE(*found.least_round, *found.mean_round);
    EXPECT_LE(*found.mean_round, *found.largest_round);
    return std::max(std::abs(*found.least_round - exact), std::abs(*found.largest_round - exact));
}

// A quarter of the step: an error of second order is a sixteenth, about, as it depends on where between samples rounds
// end.
void expect_second_order(const std::string& paths, double way, double exact, double size) {
    constexpr int kRounds = 20;
    double whole = 0, quarter = 0;
    for (const double period : kAwkward) {
        whole += error_of(figures(paths, period, way, kRounds), exact, kRounds);
        quarter += error_of(figures(paths, 4 * period, way, kRounds), exact, kRounds);
    }
    EXPECT_LT(whole, 0.06 * size) << paths;
    EXPECT_LT(quarter, std::max(whole / 10, 1e-12 * size)) << paths;
}

// At one depth the shaded plane's force has a potential.
TEST(Round, NoWorkRoundACircle) {
    const double length = 0.008, force = kRoundStiffness * 1e-3;
    expect_second_order("kind = \"circle\"\nlength = \"8 mm\"\ncentre = [\"4 mm\", \"1 mm\"]\n",
                        std::numbers::pi * length, 0, force * length);
}

// There and back at one depth, turning where the force pushes along the stroke.
TEST(Round, NoWorkThereAndBack) {
    expect_second_order("length = \"8 mm\"\ncentre = [\"4 mm\", \"1 mm\"]\n", 0.016, 0, kRoundStiffness * 1e-3 * 0.008);
    expect_second_order("length = \"8 mm\"\ncentre = [\"3 mm\", \"0 m\"]\nheading = \"30 deg\"\n", 0.016, 0,
                        kRoundStiffness * 1e-3 * 0.008);
}

// There at 2 mm and back at 1 mm, from the Gaussian's top to where it is flat: the work is that of the force along the
// stroke, K (d1 - d2) times the integral of |U'| / sqrt(1 + U'^2).
TEST(Round, WorkRoundARectangle) {
    const double end = 5 * kRadius;
    const auto slope = [](double x) {
        const double steep = 2 * kHeight * x / (kRadius * kRadius) * std::exp(-x * x / (kRadius * kRadius));
        return steep / std::sqrt(1 + steep * steep);
    };
    constexpr int kCells = 20000;
    double integral = 0; // Simpson's
    for (int i = 0; i < kCells; ++i) {
        const double from = end * i / kCells, to = end * (i + 1) / kCells;
        integral += (slope(from) + 4 * slope((from + to) / 2) + slope(to)) * (to - from) / 6;
    }
    const double exact = kRoundStiffness * 1e-3 * integral;
    const std::string keys = fmt::format(
        "length = \"{} m\"\ncentre = [\"{} m\", \"0 m\"]\ndepth = \"2 mm\"\ndepth_back = \"1 mm\"\n", end, end / 2);
    expect_second_order(keys, 2 * end, exact, exact);
    const PathFigures found = figures(keys, 400.37, 2 * end, 20);
    EXPECT_NEAR(*found.mean_round, exact, 1e-3 * exact);
    EXPECT_GT(exact, 1e-4);
}

// Tremor beside it: the rounds are closed none the less.
TEST(Round, TremorAndAJumpOfDepth) {
    const double end = 5 * kRadius;
    const std::string keys = fmt::format("length = \"{} m\"\ncentre = [\"{} m\", \"0 m\"]\ndepth = \"2 mm\"\n"
                                         "depth_back = \"1 mm\"\n",
                                         end, end / 2);
    const std::string tremor = "tremor = { amplitude = \"10 um\", frequency = \"8 Hz\" }\n";
    const PathFigures still = figures(keys, 400.37, 2 * end, 20), shaken = figures(keys + tremor, 400.37, 2 * end, 20);
    EXPECT_NEAR(*shaken.least_round, *still.mean_round, 0.05 * *still.mean_round);
    EXPECT_NEAR(*shaken.largest_round, *still.mean_round, 0.05 * *still.mean_round);
}

// Once the hand has settled, the work of a round varies smoothly with the period, whole numbers of samples or not.
TEST(Round, OfAHandThatIsPulledRound) {
    const auto settled = [](double period) {
        const char* keys = "kind = \"circle\"\nlength = \"8 mm\"\ncentre = [\"4 mm\", \"1 mm\"]\nloop = \"closed\"\n";
        const double way = std::numbers::pi * 0.008;
        return 2 * *figures(keys, period, way, 40).mean_round - *figures(keys, period, way, 20).mean_round;
    };
    const double few = settled(200), between = settled(200.41), many = settled(201);
    EXPECT_NEAR(between, std::lerp(few, many, 0.41), 1e-7) << few << ' ' << many;
}

// Those that have ended; the mean is of all of them.
TEST(Round, CountsWholeOnes) {
    const PathFigures none = figures("length = \"8 mm\"\n", 100, 0.016, 0);
    EXPECT_EQ(none.rounds, 0u);
    EXPECT_FALSE(none.least_round || none.mean_round || none.largest_round);
    const PathFigures three = figures("length = \"8 mm\"\n", 100, 0.016, 3);
    EXPECT_EQ(three.rounds, 3u);
    EXPECT_NEAR(3 * *three.mean_round, three.work, 1e-10);
}

// What a plate's rim lets go of falls; a loop that is too stiff throws the probe out.
TEST(Left, OffARimOrByGrowing) {
    forceshade::testing::Folder folder;
    std::ofstream(folder / "plate.obj") << "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n";
    const PreparedCase prepared = prepared_scene("[surface]\nkind = \"mesh\"\nfile = \"plate.obj\"\nunit = \"cm\"\n"
                                                 "[paths]\ncount = 1\nsteps = 4000\nlength = \"30 mm\"\n"
                                                 "centre = [\"15 mm\", \"0 m\"]\npress = \"1 N\"\n"
                                                 "bound = \"50 mm\"\nspeed = \"20 mm/s\"\n",
                                                 folder.path());
    ScenePaths<float> source(prepared);
    const auto fallen = explored(source, {}, false).metrics.front();
    EXPECT_NE(fallen.unstable_step, layout::kNever);
    EXPECT_GT(fallen.contact_samples, 100u);
    EXPECT_TRUE(figures_of(fallen, {4000, kRate, true}).fell);

    const auto grown = explored<float>("[force]\nstiffness = \"1000 N/mm\"\n[paths]\ncount = 1\npress = \"1 N\"\n"
                                       "bound = \"50 mm\"\nstart_depth = \"1 mm\"\n[hand]\nmax_force = \"1e6 N\"\n",
                                       {}, false)
                           .metrics.front();
    EXPECT_NE(grown.unstable_step, layout::kNever);
    EXPECT_FALSE(figures_of(grown, {2000, kRate, true}).fell);
}

} // namespace
} // namespace forceshade
