// What a device does to the loop: friction, quantised positions, a largest force, delay; and the exact map of the hand
// against a Taylor series of its matrix in two hundred digits.
#include <array>
#include <cmath>
#include <random>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <fmt/format.h>
#include <gtest/gtest.h>

#include "host/field/case_law.h"
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
        const auto hand = hand_params<double>(spec, PathsSpec{}, 1, 1000);
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

HandSpec coupled_hand(double stiffness, double damping) {
    HandSpec hand;
    hand.coupling_stiffness = stiffness;
    hand.coupling_damping = damping;
    return hand;
}

// N: the force of a wall of `stiffness`, N/m, on a probe at these depths, m, one a sample of 1 ms, through a coupling.
std::vector<double> felt_at(const HandSpec& hand, double stiffness, const std::vector<double>& depths,
                            bool begun = true) {
    const auto coupling = coupling_of<double>(hand, stiffness, 1e-3);
    std::vector<double> felt;
    double lag = begun ? 0 : -1;
    for (const double depth : depths)
        felt.push_back(reference::through_coupling(coupling, Vector<double>(0, 0, stiffness * depth), depth, lag).z);
    return felt;
}

TEST(Coupling, OfARigidWallIsItsSpringAndItsDamper) {
    const std::vector<double> depths{1e-3, 1.5e-3, 1.2e-3, 1.2e-3, 1.1e-3};
    const std::vector<double> felt = felt_at(coupled_hand(2000, 0.5), 1e13, depths);
    for (std::size_t i = 0; i < depths.size(); ++i)
        EXPECT_NEAR(felt[i], 2000 * depths[i] + 0.5 * (depths[i] - (i == 0 ? 0 : depths[i - 1])) / 1e-3, 1e-6) << i;
}

// v <- v + (dx / T - v) T / (T + t) a sample, recomputed here.
TEST(Coupling, ItsDamperTakesTheSpeedThroughAFilter) {
    const std::vector<double> depths{1e-3, 1.5e-3, 1.2e-3, 1.2e-3, 1.1e-3, 1.3e-3};
    HandSpec hand = coupled_hand(2000, 0.5);
    hand.coupling_filter = 4e-3;
    const std::vector<double> felt = felt_at(hand, 1e13, depths);
    double speed = 0, before = 0; /* m/s, m */
    for (std::size_t i = 0; i < depths.size(); ++i) {
        speed += ((depths[i] - before) / 1e-3 - speed) / 5;
        before = depths[i];
        EXPECT_NEAR(felt[i], 2000 * depths[i] + 0.5 * speed, 1e-6) << i;
    }
    hand.coupling_filter = 0;
    EXPECT_EQ(felt_at(hand, 1e4, depths), felt_at(coupled_hand(2000, 0.5), 1e4, depths));
}

TEST(Coupling, AtRestIsInLineWithTheScene) {
    EXPECT_NEAR(felt_at(coupled_hand(2000, 4), 1000, std::vector<double>(200, 2e-3)).back(), 2e-3 * 2000 / 3, 1e-12);
    for (const double felt : felt_at(coupled_hand(2000, 4), 1000, std::vector<double>(5, 2e-3), false))
        EXPECT_NEAR(felt, 2e-3 * 2000 / 3, 1e-12); // as a path begins
    EXPECT_EQ(felt_at(HandSpec{}, 1000, {2e-3}).front(), 2);
}

// Drawn out faster than the damper follows, the tool leaves the wall before the probe does, and pulls at nothing.
TEST(Coupling, NeverPulls) {
    const std::vector<double> felt = felt_at(coupled_hand(100, 5), 1e9, {1e-3, 1e-3, 1e-4, 1e-4, 0, 0, 2e-3});
    EXPECT_GT(felt[1], 0);
    EXPECT_EQ(felt[2], 0);
    for (const double force : felt)
        EXPECT_GE(force, 0);
    EXPECT_GT(felt.back(), 0);
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
        ASSERT_TRUE(result.finite()) << power;
        for (std::size_t path = 0; path < result.paths; ++path) {
            const auto& metrics = result.metrics[path];
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

TEST(Extremes, OfStiffnessAreNumbersOrLeave) {
    stay_or_leave<double>();
    stay_or_leave<float>();
}

using Exact = boost::multiprecision::number<boost::multiprecision::cpp_bin_float<250>, boost::multiprecision::et_off>;
using Square = std::array<std::array<Exact, 3>, 3>;

Square product(const Square& a, const Square& b) {
    Square c{};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            for (std::size_t k = 0; k < 3; ++k)
                c[i][j] += a[i][k] * b[k][j];
    return c;
}

// exp(A t) of error, speed and force.
Square exponential(const Axis& axis, double period) {
    const Exact m = axis.mass, t = period;
    Square a{};
    a[0][1] = t;
    a[1] = {-Exact(axis.stiffness) / m * t, -Exact(axis.damping) / m * t, t / m};
    Exact size = 0;
    for (const auto& row : a)
        for (const Exact& one : row)
            size = size < abs(one) ? Exact(abs(one)) : size;
    int halvings = 0;
    for (; size > Exact(0.01); size /= 2)
        ++halvings;
    for (auto& row : a)
        for (Exact& one : row)
            one = ldexp(one, -halvings);
    Square sum{}, term{};
    for (std::size_t i = 0; i < 3; ++i)
        sum[i][i] = term[i][i] = 1;
    for (int n = 1; n < 90; ++n) {
        term = product(term, a);
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j)
                sum[i][j] += term[i][j] /= n;
    }
    for (int i = 0; i < halvings; ++i)
        sum = product(sum, sum);
    return sum;
}

// Relative; a number too small for a double's full digits is right if it is as small.
double deviation(double found, const Exact& exact) {
    const Exact away = abs(Exact(found) - exact);
    return abs(exact) < Exact(1e-300) ? (away < Exact(1e-300) ? 0 : 1) : static_cast<double>(Exact(away / abs(exact)));
}

double largest_deviation(const Axis& axis, double period) {
    const layout::AxisMap<double> map = axis_map(axis, period);
    const Square exact = exponential(axis, period);
    double largest = 0;
    const std::array<std::pair<double, Exact>, 6> pairs{{{map.x_error, exact[0][0] - 1},
                                                         {map.x_speed, exact[0][1]},
                                                         {map.x_force, exact[0][2]},
                                                         {map.v_error, exact[1][0]},
                                                         {map.v_speed, exact[1][1]},
                                                         {map.v_force, exact[1][2]}}};
    for (const auto& [found, right] : pairs)
        largest = std::max(largest, deviation(found, right));
    return largest;
}

double power_of_ten(std::mt19937_64& random, double low, double high) {
    return std::pow(10, std::uniform_real_distribution<double>(low, high)(random));
}

TEST(HandMap, EveryCoefficientToThirteenDigits) {
    std::mt19937_64 random(4);
    for (int i = 0; i < 2000; ++i) {
        Axis axis;
        const double period = power_of_ten(random, -5, -2);
        axis.mass = power_of_ten(random, -4, 2);
        const double decay = power_of_ten(random, -7, 2), stiff = power_of_ten(random, -6, 6); // b T / 2 m, k T^2 / m
        axis.damping = i % 7 == 0 ? 0 : 2 * axis.mass / period * decay;
        axis.stiffness = i % 5 == 0 ? 0 : axis.mass / (period * period) * stiff;
        if (i % 3 == 0) { // near critical damping
            const double off = i % 9 == 0 ? 0 : (i % 9 == 3 ? 1 : -1) * power_of_ten(random, -16, -1);
            axis.stiffness = axis.damping * axis.damping / (4 * axis.mass) * (1 + off);
        }
        EXPECT_LT(largest_deviation(axis, period), 1e-13)
            << axis.mass << ' ' << axis.damping << ' ' << axis.stiffness << ' ' << period;
    }
}

TEST(HandMap, ExtremesAreNumbers) {
    for (const double mass : {1e-12, 1e-3, 1e12})
        for (const double damping : {0.0, 1e-150, 1.0, 1e12})
            for (const double stiffness : {0.0, 1e-150, 1.0, 1e12})
                for (const double period : {1e-9, 1e-3, 1e6}) {
                    const layout::AxisMap<double> map = axis_map({mass, damping, stiffness}, period);
                    for (const double one :
                         {map.x_error, map.x_speed, map.x_force, map.v_error, map.v_speed, map.v_force})
                        EXPECT_TRUE(std::isfinite(one)) << mass << ' ' << damping << ' ' << stiffness << ' ' << period;
                }
}

} // namespace
} // namespace forceshade
