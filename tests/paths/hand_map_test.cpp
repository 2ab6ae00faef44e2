// The exact map of mass, damping and spring against a Taylor series of its matrix in two hundred digits.
#include "host/paths/scene_paths.h"

#include <array>
#include <cmath>
#include <random>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <gtest/gtest.h>

namespace forceshade {
namespace {

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
    for (int i = 0; i < 1500; ++i) {
        Axis axis;
        const double period = power_of_ten(random, -5, -2);
        axis.mass = power_of_ten(random, -4, 2);
        const double decay = power_of_ten(random, -7, 2), stiff = power_of_ten(random, -6, 6); // b T / 2 m, k T^2 / m
        axis.damping = i % 7 == 0 ? 0 : 2 * axis.mass / period * decay;
        axis.stiffness = i % 5 == 0 ? 0 : axis.mass / (period * period) * stiff;
        EXPECT_LT(largest_deviation(axis, period), 1e-13)
            << axis.mass << ' ' << axis.damping << ' ' << axis.stiffness << ' ' << period;
    }
}

TEST(HandMap, NearCriticalDamping) {
    std::mt19937_64 random(5);
    for (int i = 0; i < 600; ++i) {
        Axis axis{0.1, 0, 0};
        const double period = 1e-3, decay = power_of_ten(random, -4, 2);
        axis.damping = 2 * axis.mass / period * decay;
        const double off = i % 3 == 0 ? 0 : (i % 3 == 1 ? 1 : -1) * power_of_ten(random, -16, -1);
        axis.stiffness = axis.mass / (period * period) * decay * decay * (1 + off);
        EXPECT_LT(largest_deviation(axis, period), 1e-13) << decay << ' ' << off;
    }
}

TEST(HandMap, ClosedFormsWithoutSpring) {
    const Axis axis{0.1, 1, 0};
    const layout::AxisMap<double> map = axis_map(axis, 1e-3);
    const double decay = std::exp(-0.01);
    EXPECT_EQ(map.x_error, 0);
    EXPECT_EQ(map.v_error, 0);
    EXPECT_NEAR(map.v_speed, decay, 1e-16);
    EXPECT_NEAR(map.x_speed, 0.1 * (1 - decay), 1e-16);
    EXPECT_NEAR(map.x_force, (1e-3 - 0.1 * (1 - decay)) / 1, 1e-16);
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
