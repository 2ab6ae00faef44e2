// How steeply the force turns along a path: against closed forms, for ways however short.
#include <cmath>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/paths/path_files.h"
#include "host/reference/path_step.h"
#include "tests/paths/explored.h"

namespace forceshade {
namespace {

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
