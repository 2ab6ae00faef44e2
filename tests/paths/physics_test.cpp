// The oracle against closed forms: sampled stability, flutter, and the paths of the paper (shaders/README.md).
#include <cmath>
#include <complex>
#include <numbers>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "tests/paths/explored.h"
#include "tests/paths/sampled_plants.h"

namespace forceshade {
namespace {

using testing::kPlants;
using testing::Plant;

constexpr double kMil = 25.4e-6; // m

// The logarithm of how much faster a probe moves in the last quarter of its time than in the second.
double growth(const std::string& scene) {
    const auto result = explored<double>(scene, {}, false);
    const auto& metrics = result.metrics.front();
    EXPECT_EQ(metrics.unstable_step, layout::kNever);
    return std::log(metrics.late_speed / metrics.early_speed);
}

// Where something that increases is zero, between two places on both sides of it.
template <typename Function> double zero_of(double low, double high, const Function& function) {
    for (int i = 0; i < 25; ++i) {
        const double middle = (low + high) / 2;
        (function(middle) < 0 ? low : high) = middle;
    }
    return (low + high) / 2;
}

// At rest but a ten thousandth of its depth too deep.
std::string pressed(const Plant& plant, double stiffness, int delay) {
    const double keeps = std::exp(-plant.damping * plant.period / plant.mass); // of its speed, in a sample
    return testing::pressed_scene(
        plant, stiffness, 1.0001,
        fmt::format("count = 1\nsteps = {}\nrate = \"{} Hz\"\n", static_cast<int>(400 / (1 - keeps)), 1 / plant.period),
        fmt::format("delay_samples = {}\nmax_force = \"1000 N\"\n", delay));
}

TEST(SampledStability, LimitOfAPlaneToATenthOfAPercent) {
    for (const Plant& plant : kPlants)
        for (const int delay : {0, 1}) {
            const double right = delay ? plant.limit_late : plant.limit;
            const double found = zero_of(0.99 * right, 1.01 * right,
                                         [&](double stiffness) { return growth(pressed(plant, stiffness, delay)); });
            EXPECT_NEAR(found, right, 1e-3 * right) << plant.mass << ' ' << plant.damping << ' ' << delay;
        }
}

// m: above its place of rest, after `count` samples of T, of a mass that begins at `from` and is held by the plane's
// force of each sample until the next: m e'' = -b e' - K e_k. By the powers of the matrix that takes (e, e') over a
// sample.
double held_plane(const Plant& plant, double stiffness, double from, int count) {
    const double decay = std::exp(-plant.damping * plant.period / plant.mass);
    const double pace = plant.mass / plant.damping * (1 - decay); // s: of a speed, the way of a sample
    const double place = 1 - stiffness / plant.damping * (plant.period - pace),
                 speed = -stiffness / plant.damping * (1 - decay);
    const std::complex<double> half = (place + decay) / 2, root = std::sqrt(half * half - place * decay + pace * speed);
    const std::complex<double> one = half + root, other = half - root;
    const auto powers = [&](int n) { return (std::pow(one, n) - std::pow(other, n)) / (2.0 * root); };
    return from * (powers(count) * place - one * other * powers(count - 1)).real();
}

// Paths over the time step: each is the sampled loop's exact solution, and comes as much closer to that of a plane
// whose force is not held as the step is shorter.
TEST(PressedPlane, IsSampledExactlyAtAnyRate) {
    constexpr double kStiffness = 1000, kTime = 0.2, kForce = 1;
    const double rest = kForce / kStiffness, from = -0.3 * rest; // begins deeper
    std::vector<double> off;
    for (const double rate : {1000.0, 4000.0, 16000.0}) {
        const Plant plant{.mass = 0.1, .damping = 2, .period = 1 / rate, .limit = 0, .limit_late = 0};
        const int steps = static_cast<int>(kTime * rate);
        const auto result = explored<double>(testing::pressed_scene(
            plant, kStiffness, 1.3, fmt::format("count = 1\nsteps = {}\nrate = \"{} Hz\"\n", steps, rate)));
        const double half = plant.damping / (2 * plant.mass),
                     pulsation = std::sqrt(kStiffness / plant.mass - half * half); // 1/s
        double of_held = 0, square = 0;
        for (int step = 0; step < steps; ++step) {
            const double above = result.place(static_cast<std::size_t>(step)).z + rest, time = step / rate;
            const double free = from * std::exp(-half * time) *
                                (std::cos(pulsation * time) + half / pulsation * std::sin(pulsation * time));
            of_held = std::max(of_held, std::abs(above - held_plane(plant, kStiffness, from, step)));
            square += (above - free) * (above - free) / steps;
        }
        EXPECT_LT(of_held, 1e-11 * rest) << rate;
        off.push_back(std::sqrt(square) / rest);
    }
    EXPECT_NEAR(off[0], 0.0195, 0.0005);
    EXPECT_NEAR(off[0] / off[1], 4, 0.5);
    EXPECT_NEAR(off[1] / off[2], 4, 0.15);
}

// A probe held by a constant force on a slope of 50 degrees of a shaded dip, off its place by a thousandth of a
// millimetre.
std::string fluttering(double stiffness, double rate) {
    constexpr double kRadius = 0.025, kDepth = 0.131 * kRadius;
    const double slope = 50 * std::numbers::pi / 180, force = stiffness * kDepth;
    return fmt::format(R"(
[surface]
kind = "height_map"
function = "dip"
radius = "{0} m"
width = "{1} m"
[force]
stiffness = "{2} N/m"
shading = "height_map"
[paths]
count = 1
steps = {3}
rate = "{4} Hz"
length = "0 m"
centre = ["{5} m", "0 m"]
push = ["{6} N", "0 N", "{7} N"]
start_depth = "{8} m"
[hand]
mass = "0.1 kg"
damping = "1 N s/m"
grip_stiffness = "0 N/m"
grip_damping = "0 N s/m"
)",
                       kRadius, 1.9 * kRadius, stiffness, static_cast<int>(8 * rate), rate,
                       kRadius * std::sin(slope) + 1e-6, force * std::sin(slope), -force * std::cos(slope), kDepth);
}

TEST(Flutter, LimitOfAShadedDip) {
    const auto limit = [](double rate) {
        return zero_of(60, 80, [&](double stiffness) { return growth(fluttering(stiffness, rate)); });
    };
    const double held = limit(1000), continuous = limit(20000);
    EXPECT_NEAR(continuous, 71, 0.03 * 71);
    EXPECT_NEAR(held, 69, 0.03 * 69);
}

// As in the paper: over a shaded bump the probe goes along the polygon while the force turns as on the cylinder.
TEST(ShadedBump, ProbeFollowsThePolygonAndForceTheCylinder) {
    constexpr double kStiffness = 1000, kRadius = 1000 * kMil, kHalf = 500 * kMil;
    const double base = std::sqrt(kRadius * kRadius - kHalf * kHalf);
    const auto result = explored<double>(R"(
[surface]
facets = 2
radius = "1000 mil"
[force]
shading = "reference"
[paths]
count = 1
steps = 6000
speed = "50 mm/s"
press = "1 N"
start_depth = "1 mm"
)");
    double square = 0, square_round = 0, angle = 0;
    int samples = 0;
    for (std::size_t step = 500; step < result.steps; ++step) {
        const auto& place = result.place(step);
        const auto& force = result.force[step];
        const double size = std::sqrt(reference::dot(force, force));
        if (std::abs(place.x) >= kHalf || size == 0)
            continue;
        const double away = place.z - ((kRadius - base) * (1 - std::abs(place.x) / kHalf) - 1 / kStiffness);
        const double round = std::sqrt(kRadius * kRadius - place.x * place.x) - base - 1 / kStiffness;
        square += away * away;
        square_round += (place.z - round) * (place.z - round);
        angle = std::max(angle, std::abs(force.x / size - place.x / kRadius));
        ++samples;
    }
    EXPECT_GT(samples, 3000);
    EXPECT_LT(std::sqrt(square / samples), 3e-4);
    EXPECT_LT(4 * square, square_round); // and not along the cylinder
    EXPECT_LT(angle, 1e-12);
}

} // namespace
} // namespace forceshade
