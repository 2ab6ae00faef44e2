#include "host/output/rows.h"

#include <bit>
#include <cmath>
#include <limits>
#include <vector>

#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace forceshade {
namespace {

constexpr float kLargest = std::numeric_limits<float>::max();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

TEST(Float24, is_the_nearest_with_fifteen_bits_of_fraction) {
    EXPECT_TRUE(rc::check([](std::uint32_t bits) {
        const auto value = std::bit_cast<float>(bits);
        RC_PRE(std::isfinite(value) && value != 0.0f);
        const float rounded = round_to_float24(value);
        RC_ASSERT(std::isfinite(rounded));
        RC_ASSERT(round_to_float24(rounded) == rounded);
        RC_ASSERT((std::bit_cast<std::uint32_t>(rounded) & 0xffu) == 0);
        const double step =
            std::max(std::ldexp(1.0, std::ilogb(value) - 15), 0x1p-141); // below 2^-126 the grid is even
        const bool at_the_end = std::abs(value) > 0x1.fffep127f;         // truncated rather than infinite
        RC_ASSERT(std::abs(static_cast<double>(rounded) - static_cast<double>(value)) <=
                  (at_the_end ? 1.0 : 0.5) * step);
    }));
    EXPECT_EQ(std::bit_cast<std::uint32_t>(round_to_float24(-0.0f)), 0x80000000u);
    EXPECT_EQ(round_to_float24(kLargest), 0x1.fffep127f);
    EXPECT_EQ(round_to_float24(-kInfinity), -kInfinity);
    EXPECT_TRUE(std::isnan(round_to_float24(std::numeric_limits<float>::quiet_NaN())));
    EXPECT_TRUE(std::isnan(round_to_float24(std::bit_cast<float>(0x7f800001u))));
}

TEST(Half, overflows_from_65520) {
    EXPECT_FALSE(overflows_half(65519.996f));
    EXPECT_TRUE(overflows_half(65520.0f));
    EXPECT_TRUE(overflows_half(-kLargest));
    EXPECT_FALSE(overflows_half(kInfinity)); // it is none that becomes infinite
}

TEST(PixelWatch, finds_the_first_of_the_largest) {
    PixelWatch watch(3);
    const std::vector<float> first{0, 0, 0, 3, 4, 0}, second{0, -5, 0, 0, 0, 4};
    watch.add(first, 0, 0, 2);
    watch.add(second, 2, 0, 1);
    EXPECT_EQ(watch.largest().value, -5.0);
    EXPECT_EQ(watch.largest().voxel, (Voxel{0, 2, 0}));
    EXPECT_EQ(watch.longest().value, 5.0);
    EXPECT_EQ(watch.longest().voxel, (Voxel{1, 0, 0}));
    EXPECT_EQ(watch.non_finite(), 0u);
}

TEST(PixelWatch, counts_what_is_not_finite_and_looks_past_it) {
    PixelWatch watch(3);
    const std::vector<float> row{kInfinity, 9, 0, 0, 2, 0, std::nanf(""), 0, 0, kLargest, kLargest, kLargest};
    watch.add(row, 1, 2, 10);
    EXPECT_EQ(watch.non_finite(), 20u);
    EXPECT_EQ(watch.first_non_finite().voxel, (Voxel{0, 1, 2}));
    EXPECT_EQ(watch.largest().value, static_cast<double>(kLargest));
    EXPECT_NEAR(watch.longest().value / static_cast<double>(kLargest), std::sqrt(3.0), 1e-15);
    EXPECT_EQ(watch.longest().voxel, (Voxel{3, 1, 2}));
}

TEST(PixelWatch, of_nothing_but_zeros_is_the_first_voxel) {
    PixelWatch watch(3);
    watch.add(std::vector<float>(9, 0.0f), 0, 0, 1);
    EXPECT_TRUE(watch.longest().found);
    EXPECT_EQ(watch.longest().value, 0.0);
    EXPECT_EQ(watch.longest().voxel, (Voxel{0, 0, 0}));
}

} // namespace
} // namespace forceshade
