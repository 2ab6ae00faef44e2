// cos and exp out of + - *: close to the library's everywhere, exact where it matters.
#include <bit>
#include <cmath>
#include <limits>
#include <numbers>
#include <random>

#include <gtest/gtest.h>

#include "host/referee/rounding_bound.h"
#include "host/reference/elementary.h"

namespace forceshade::test {
namespace {

template <typename T> void expect_cosine(T turns, double ulps_of_one) {
    // Reduced in extended precision, so that the expected value is exact for large arguments too.
    const long double reduced = std::remainder(static_cast<long double>(turns), 1.0L);
    const auto expected = static_cast<double>(std::cos(2 * std::numbers::pi_v<long double> * reduced));
    EXPECT_NEAR(static_cast<double>(reference::cosine_of_turns(turns)), expected,
                ulps_of_one * static_cast<double>(std::numeric_limits<T>::epsilon()))
        << "turns = " << turns;
}

TEST(Elementary, CosineWithinTwoUlpOfOne) {
    std::mt19937_64 random(7);
    for (int i = 0; i < 200000; ++i) {
        const double turns = std::ldexp(static_cast<double>(random()) / 0x1p64 - 0.5, static_cast<int>(random() % 24));
        expect_cosine(static_cast<float>(turns), 2);
        expect_cosine(turns, 2);
    }
    for (const double turns : {0.0, 0.25, 0.5, 0.75, 1.0, -0.25, 1e6, 1e15, 123456.75})
        expect_cosine(turns, 2);
}

TEST(Elementary, CosineIsZeroAtQuarterTurns) {
    for (const double turns : {0.25, 0.75, -0.25, 1.25, 1024.75}) {
        EXPECT_EQ(reference::cosine_of_turns(turns), 0.0);
        EXPECT_EQ(reference::cosine_of_turns(static_cast<float>(turns)), 0.0f);
    }
}

template <typename T> void expect_decay(T u, std::uint64_t ulps) {
    const T expected = static_cast<T>(std::exp(-static_cast<long double>(u)));
    EXPECT_LE(ulp_distance(reference::exponential_decay(u), expected), ulps) << "u = " << u;
}

TEST(Elementary, DecayWithinTwoUlp) {
    std::mt19937_64 random(8);
    for (int i = 0; i < 200000; ++i) {
        const double unit = static_cast<double>(random() >> 11) / 0x1p53;
        expect_decay(static_cast<float>(unit * 86.9), 2);
        expect_decay(unit * 707.9, 2);
        expect_decay(unit, 2);
        expect_decay(static_cast<float>(unit * 1e-3), 2);
    }
}

TEST(Elementary, DecayAtItsEnds) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(reference::exponential_decay(0.0), 1.0);
    EXPECT_EQ(reference::exponential_decay(0.0f), 1.0f);
    EXPECT_EQ(reference::exponential_decay(kInfinity), 0.0);
    EXPECT_EQ(reference::exponential_decay(87.0f), 0.0f);
    EXPECT_GT(reference::exponential_decay(std::nextafter(87.0f, 0.0f)), 0.0f);
    EXPECT_EQ(reference::exponential_decay(std::numeric_limits<double>::quiet_NaN()), 0.0);
}

// True of every argument; here of one in some hundreds.
TEST(Elementary, TermsLeftOutInSinglePrecisionChangeNoBit) {
    std::size_t different = 0;
    for (std::uint32_t bits = 0; bits <= std::bit_cast<std::uint32_t>(0.5f); bits += 521) {
        const auto turns = std::bit_cast<float>(bits);
        different += reference::cosine_of_turns(turns) != reference::cosine_of_turns<float, 0>(turns);
    }
    for (std::uint32_t bits = 0; bits < std::bit_cast<std::uint32_t>(87.0f); bits += 523) {
        const auto u = std::bit_cast<float>(bits);
        different += reference::exponential_decay(u) != reference::exponential_decay<float, 0>(u);
    }
    EXPECT_EQ(different, 0u);
}

TEST(Elementary, UlpDistanceCounts) {
    EXPECT_EQ(ulp_distance(1.0f, std::nextafter(1.0f, 2.0f)), 1u);
    EXPECT_EQ(ulp_distance(0.0f, std::numeric_limits<float>::denorm_min()), 1u);
    EXPECT_EQ(ulp_distance(0.0, -0.0), 1u);
    EXPECT_EQ(ulp_distance(-1.0, 1.0), ulp_distance(1.0, -1.0));
    EXPECT_EQ(ulp_distance(1.0f, std::numeric_limits<float>::quiet_NaN()), UINT64_MAX);
}

} // namespace
} // namespace forceshade::test
