// What a device does to the loop: friction, quantised positions, a largest force, delay; and loops beyond all bounds.
#include <cmath>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/paths/scene_paths.h"
#include "host/reference/path_step.h"
#include "tests/paths/explored.h"

namespace forceshade {
namespace {

using reference::Vector;

// One path that stays where it is, over a plane; `more` goes on in [hand].
std::string at_rest(const std::string& drive, const std::string& more, int steps = 400) {
    return fmt::format(R"(
[paths]
count = 1
steps = {}
length = "0 m"
{}
[hand]
{}
)",
                       steps, drive, more);
}

TEST(Friction, HoldsWhatIsPushedLess) {
    const auto moved = [](double push) {
        return explored<double>(at_rest(fmt::format("push = [\"{} N\", \"0 N\", \"0 N\"]", push),
                                        "grip_stiffness = \"0 N/m\"\ncoulomb = \"0.1 N\""))
            .place(399)
            .x;
    };
    EXPECT_EQ(moved(0.05), 0);
    EXPECT_EQ(moved(-0.1), 0);
    EXPECT_EQ(moved(0.1), 0);
    EXPECT_GT(moved(0.11), 1e-5);
    EXPECT_EQ(moved(0.11), -moved(-0.11));
}

// At constant speed a push of more than the friction balances it and the damping.
TEST(Friction, TakesItsForceFromThePush) {
    const auto result =
        explored<double>(at_rest("push = [\"0.4 N\", \"0 N\", \"0 N\"]\nbound = \"10 m\"",
                                 "grip_stiffness = \"0 N/m\"\ngrip_damping = \"0 N s/m\"\ncoulomb = \"0.1 N\"", 2000));
    const double speed = (result.place(1999).x - result.place(1998).x) * 1000;
    EXPECT_NEAR(speed, (0.4 - 0.1) / 1, 1e-6);
}

TEST(Friction, TakesEnergy) {
    for (const double coulomb : {0.0, 0.01, 0.3}) {
        HandSpec spec;
        spec.coulomb = coulomb;
        spec.damping = coulomb > 0 ? 0 : 1e-3;
        spec.grip_damping = 0;
        const auto hand = hand_params<double>(spec, PathsSpec{}, 1);
        reference::ProbeState<double> now{{0.01, -0.004, 0.003}, {0.1, 0, -0.2}};
        const auto energy = [&] {
            return 0.05 * reference::dot(now.speed, now.speed) + 250 * reference::dot(now.place, now.place);
        };
        double last = energy();
        for (int i = 0; i < 3000; ++i) {
            now = reference::advance_hand(hand, now, Vector<double>(0.0), Vector<double>(0.0), Vector<double>(0.0));
            EXPECT_LE(energy(), last * (1 + 1e-12)) << coulomb << ' ' << i;
            last = energy();
        }
        if (coulomb > 0.1) { // long enough to come to rest
            for (int axis = 0; axis < 3; ++axis) {
                EXPECT_EQ(now.speed[axis], 0);
                EXPECT_LE(500 * std::abs(now.place[axis]), coulomb);
            }
        }
    }
}

TEST(Measurement, PositionsAreMultiples) {
    const double quantum = 0.00003;
    const auto result = explored<double>(R"(
[paths]
count = 3
press = "1 N"
heading = { min = "0 deg", max = "90 deg" }
[hand]
quantisation = "0.03 mm"
)");
    for (const auto& place : result.position)
        for (int axis = 0; axis < 3; ++axis)
            EXPECT_EQ(place[axis], std::round(place[axis] / quantum) * quantum);
}

TEST(Display, NoForceBeyondTheLargest) {
    const auto result = explored<double>(at_rest("press = \"20 N\"\nstart_depth = \"30 mm\"", "max_force = \"8.5 N\""));
    double largest = 0;
    for (const auto& force : result.force)
        largest = std::max(largest, std::sqrt(reference::dot(force, force)));
    EXPECT_NEAR(largest, 8.5, 1e-12);
    EXPECT_EQ(result.metrics.front().largest_force, largest);
    EXPECT_NE(result.metrics.front().unstable_step, layout::kNever); // it is pushed through
}

// The force displayed is that of the sample before: the first sample's push acts alone.
TEST(Display, DelayIsOneSample) {
    const auto run = [](int delay) {
        return explored<double>(at_rest("press = \"0 N\"\nstart_depth = \"1 mm\"",
                                        fmt::format("grip_damping = \"0 N s/m\"\ndelay_samples = {}", delay)));
    };
    const auto prompt = run(0), late = run(1);
    EXPECT_GT(prompt.place(1).z, prompt.place(0).z);
    EXPECT_EQ(late.place(1).z, late.place(0).z);
    EXPECT_DOUBLE_EQ(late.place(2).z - late.place(1).z, prompt.place(1).z - prompt.place(0).z);
}

// K T^2 / m over twelve decades: what is stable stays, what is not is told, and no number is lost.
template <typename T> void stay_or_leave() {
    constexpr double kMass = 0.1, kPeriod = 1e-3;
    for (int power = -6; power <= 6; ++power) {
        const double stiffness = std::pow(10, power) * kMass / (kPeriod * kPeriod); // K_crit is 2003 N/m
        const auto result = explored<T>(fmt::format(R"(
[force]
stiffness = "{} N/m"
[paths]
count = 20
steps = 3000
speed = {{ min = "10 mm/s", max = "1 m/s" }}
press = "1 N"
start_depth = "{} m"
bound = "50 mm"
[hand]
max_force = "1e12 N"
grip_stiffness = "0 N/m"
grip_damping = "0 N s/m"
)",
                                                    stiffness, 1.001 / stiffness));
        for (const auto& place : result.position)
            ASSERT_TRUE(is_finite(place)) << power;
        for (const auto& force : result.force)
            ASSERT_TRUE(is_finite(force)) << power;
        for (std::size_t path = 0; path < result.paths; ++path) {
            const auto& metrics = result.metrics[path];
            ASSERT_TRUE(std::isfinite(metrics.work) && std::isfinite(metrics.force_square));
            if (metrics.unstable_step == layout::kNever)
                continue;
            for (std::size_t step = std::max(1u, metrics.unstable_step); step < result.steps; ++step) {
                EXPECT_EQ(result.place(step, path), result.place(step - 1, path));
                EXPECT_EQ(result.force[step * result.paths + path], Vector<T>(T(0)));
            }
        }
        const bool left = result.metrics.front().unstable_step != layout::kNever;
        if (power == -3 || power == -2) {
            EXPECT_FALSE(left) << power;
        }
        if (power <= -5 || power >= 0) { // rests deeper than the bound, or is thrown out
            EXPECT_TRUE(left) << power;
        }
    }
}

TEST(Extremes, StiffnessDouble) {
    stay_or_leave<double>();
}
TEST(Extremes, StiffnessFloat) {
    stay_or_leave<float>();
}

} // namespace
} // namespace forceshade
