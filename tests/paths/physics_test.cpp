// The oracle against closed forms: sampled stability, flutter, and the paths of the paper (shaders/README.md).
#include <cmath>
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
