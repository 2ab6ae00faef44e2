// What is felt along a path: the work done on the hand in each round, and how steeply the force turns.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/paths/path_files.h"
#include "host/reference/path_step.h"
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
    const testing::Folder folder;
    folder.write("plate.obj", "v -1 -1 0\nv 1 -1 0\nv 1 1 0\nv -1 1 0\nf 1 2 3 4\n");
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

using reference::Vector;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kStretch = 1e-4; // m

// Directions of the force at places, one after the other.
template <typename T> class Turning {
public:
    // Along x, m; from z towards x, deg.
    void feel(double x, double angle, bool touches = true) {
        const Vector<T> direction{T(std::sin(angle * kDegree)), T(0), T(std::cos(angle * kDegree))};
        reference::add_turn(state_, {T(x), T(0.01), T(-0.01)}, before_, touches ? direction : Vector<T>(T(0)), touches,
                            T(kStretch));
        before_ = direction;
    }
    PathFigures figures() const { return figures_of(state_.metrics, {1, 1000}); }

private:
    layout::PathState<T> state_ = reference::state_at(Vector<T>(T(0)));
    Vector<T> before_{T(0), T(0), T(1)};
};

template <typename T> double steady(double step, double steepness) { // deg/mm
    Turning<T> path;
    for (int i = 0; i < 2000; ++i)
        path.feel(0.02 + i * step, 1000 * i * step * steepness);
    return path.figures().steepest_turn;
}

TEST(Turn, SteadyWhateverTheSteps) {
    for (const double step : {1e-9, 7e-7, 3e-5, 1e-4, 2.7e-4}) {
        const double way = std::min(1999 * step, std::max(step, kStretch));
        const double least = 3 * way / kStretch; // a path shorter than a stretch turns less over it
        EXPECT_NEAR(steady<double>(step, 3), step < kStretch ? std::min(least, 3.0) : 3, 3e-3) << step;
        EXPECT_NEAR(steady<float>(step, 3), step < kStretch ? std::min(least, 3.0) : 3, 0.03) << step;
    }
}

// A way of a rounding, and a direction that is off by one.
TEST(Turn, NoNoiseWhereAProbeHardlyMoves) {
    Turning<float> path;
    float x = 0.02f;
    for (int i = 0; i < 10000; ++i) {
        x = i % 3 ? std::nextafter(x, 1.f) : std::nextafter(x, 0.f);
        path.feel(double(x), 30 + 1e-5 * (i % 2));
    }
    EXPECT_LT(path.figures().steepest_turn, 3e-4);
}

TEST(Turn, AnAngleOverAStretchWhereItIsAJump) {
    for (const double angle : {10.0, 60.0, 120.0, 179.0, 180.0}) {
        Turning<double> path;
        for (int i = 0; i < 100; ++i)
            path.feel(1e-6 * i, i < 50 ? -angle / 2 : angle / 2);
        const PathFigures figures = path.figures();
        EXPECT_NEAR(figures.steepest_turn, angle / (1000 * kStretch), 1e-5 * angle);
        EXPECT_NEAR(figures.largest_turn, angle, 1e-6);
    }
}

TEST(Turn, TheSteeperOfTwoIsTheLargerAngleOverTheWay) {
    const auto both = [](double one, double way, double other, double other_way) {
        Turning<double> path;
        path.feel(0, 0);
        path.feel(way, one);
        path.feel(1, 0, false);
        path.feel(2, 0);
        path.feel(2 + other_way, other);
        return path.figures().steepest_turn;
    };
    EXPECT_NEAR(both(170, 1.7e-4, 80, 1e-4), 1000, 1e-6); // by chords it would be the other
    EXPECT_NEAR(both(80, 1e-4, 170, 1.7e-4), 1000, 1e-6);
    EXPECT_NEAR(both(80, 1e-4, 170, 2.3e-4), 800, 1e-6);
}

TEST(Turn, SquareOfAnAngleAsGoodAsItSays) {
    for (int i = 1; i <= 1800; ++i) {
        const double angle = 0.1 * i * kDegree, chord = 2 * std::sin(angle / 2);
        const double found = std::sqrt(reference::angle_square(chord * chord));
        EXPECT_NEAR(found / angle, 1, i <= 450 ? 4e-4 : i <= 900 ? 4e-3 : 0.05) << 0.1 * i;
    }
}

TEST(Turn, NoneAcrossALossOfContact) {
    Turning<float> path;
    for (int i = 0; i < 10; ++i)
        path.feel(1e-6 * i, 0);
    path.feel(1e-5, 0, false);
    for (int i = 11; i < 30; ++i)
        path.feel(1e-6 * i, 90);
    EXPECT_EQ(path.figures().steepest_turn, 0);
    EXPECT_EQ(path.figures().largest_turn, 0);
}

// Over the shaded cylinder the force's angle is asin(x / R), its steepness 1 / sqrt(R^2 - x^2).
template <typename T> double over_the_cylinder(const std::string& keys) {
    const auto result = explored<T>(R"(
[surface]
radius = "600 mil"
[force]
shading = "reference"
[paths]
count = 1
steps = 40000
length = "20 mm"
)" + keys,
                                    {}, false);
    return figures_of(result.metrics.front(), {result.steps, 1000}).steepest_turn;
}

TEST(Turn, OverTheCylinder) {
    const double radius = 600 * 0.0254; // mm
    const double exact = 1 / std::sqrt(radius * radius - 100) / kDegree;
    for (const char* speed : {"0.01 mm/s", "1 mm/s", "30 mm/s"}) {
        const std::string keys = fmt::format("speed = \"{}\"\n", speed);
        EXPECT_NEAR(over_the_cylinder<double>(keys), exact, 3e-3 * exact) << speed;
        EXPECT_NEAR(over_the_cylinder<float>(keys), exact, 5e-3 * exact) << speed;
    }
    // The mean over 2 mm at the end.
    EXPECT_NEAR(over_the_cylinder<double>("speed = \"30 mm/s\"\nstretch = \"2 mm\"\n"),
                (std::asin(10 / radius) - std::asin(8 / radius)) / 2 / kDegree, 3e-2);
}

TEST(Turn, StretchFollowsFromTheRegion) {
    const auto stretch = [](const std::string& keys) {
        const PreparedCase prepared = prepared_scene(keys);
        ScenePaths<float> paths(prepared);
        EXPECT_EQ(paths.input().stretch, float(paths.stretch()));
        return paths.stretch();
    };
    EXPECT_DOUBLE_EQ(stretch("[paths]\n"), 1.2e-3 * 0.0254); // of a bump of 1000 mil
    EXPECT_DOUBLE_EQ(stretch("[paths]\nlength = \"20 mm\"\n"), 2e-5);
    EXPECT_DOUBLE_EQ(stretch("[paths]\nlength = \"0 m\"\n"), 1.2e-3 * 0.0254);
    EXPECT_DOUBLE_EQ(stretch("[paths]\nstretch = \"0.1 mm\"\n"), 1e-4);
}

} // namespace
} // namespace forceshade
