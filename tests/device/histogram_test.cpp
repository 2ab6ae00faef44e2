// The histogram of times: its bins are all of the numbers, once, and its quantiles those of the sorted times.
#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include <gtest/gtest.h>

#include "device/loop/real_time.h"
#include "device/loop/sample.h"

namespace forceshade::device {
namespace {

constexpr std::uint64_t kLargest = std::numeric_limits<std::uint64_t>::max();

TEST(Histogram, ItsBinsFollowEachOtherFrom0ToTheLargestNumber) {
    EXPECT_EQ(Histogram::begin_of(0), 0u);
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
        const std::uint64_t begin = Histogram::begin_of(bin), end = Histogram::begin_of(bin + 1);
        ASSERT_LT(begin, end) << bin;
        ASSERT_EQ(Histogram::bin_of(begin), bin);
        ASSERT_EQ(Histogram::bin_of(begin + (end - begin) / 2), bin);
        ASSERT_EQ(Histogram::bin_of(end - 1), bin);
        ASSERT_LE(end - begin, std::max<std::uint64_t>(1, begin / 32)) << "no wider than that share of its times";
    }
    EXPECT_EQ(Histogram::bin_of(kLargest), Histogram::kBins - 1);
    EXPECT_EQ(Histogram::begin_of(Histogram::kBins), kLargest) << "what the end of the last bin is rounded to";
}

// Of n sorted times the least that a share of them does not exceed is number ceil(share n), counted from 1.
double sorted_quantile(const std::vector<std::int64_t>& sorted, double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(sorted.size())));
    return static_cast<double>(sorted[std::max<std::size_t>(rank, 1) - 1]);
}

TEST(Histogram, QuantilesAreThoseOfTheSortedTimesToWithinABin) {
    std::mt19937_64 random(5);
    for (const std::size_t count : {1u, 2u, 3u, 100u, 999u, 20000u})
        for (const unsigned bits : {3u, 10u, 30u, 62u}) {
            Histogram times;
            std::vector<std::int64_t> sorted;
            for (std::size_t i = 0; i < count; ++i) {
                sorted.push_back(static_cast<std::int64_t>((random() >> (64 - bits)) >> (random() % bits)));
                times.add(sorted.back());
            }
            std::sort(sorted.begin(), sorted.end());
            EXPECT_EQ(times.largest(), static_cast<std::uint64_t>(sorted.back()));
            for (const double share : {0.0, 0.01, 0.5, 0.9, 0.99, 0.999, 1.0}) {
                const double wanted = sorted_quantile(sorted, share), width = std::max(1.0, wanted / 32);
                EXPECT_GE(times.quantile(share), wanted) << count << " times, " << bits << " bits, " << share;
                EXPECT_LE(times.quantile(share), wanted + width) << count << " times, " << bits << " bits, " << share;
            }
        }
}

TEST(Histogram, CountsEachTimeOnce) {
    Histogram times;
    std::mt19937_64 random(7);
    double sum = 0;
    for (int i = 0; i < 5000; ++i) {
        const auto time = static_cast<std::int64_t>(random() >> 40);
        times.add(time);
        sum += static_cast<double>(time);
    }
    std::uint64_t counted = 0;
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin)
        counted += times.bin(bin);
    EXPECT_EQ(counted, 5000u);
    EXPECT_EQ(times.count(), 5000u);
    EXPECT_NEAR(times.mean(), sum / 5000, 1e-9 * sum);
}

TEST(Histogram, OfNothingIsNothing) {
    const Histogram times;
    EXPECT_EQ(times.count(), 0u);
    EXPECT_EQ(times.largest(), 0u);
    EXPECT_EQ(times.mean(), 0);
    EXPECT_EQ(times.quantile(0.5), 0);
}

TEST(Histogram, TakesNegativeTimesAsNoneAndTheLongestAsItIs) {
    Histogram times;
    times.add(-1);
    times.add(std::numeric_limits<std::int64_t>::min());
    EXPECT_EQ(times.bin(0), 2u);
    EXPECT_EQ(times.largest(), 0u);
    EXPECT_EQ(times.quantile(1), 0);
    constexpr std::int64_t kLongest = std::numeric_limits<std::int64_t>::max();
    times.add(kLongest);
    EXPECT_EQ(times.largest(), static_cast<std::uint64_t>(kLongest));
    EXPECT_EQ(times.bin(Histogram::bin_of(static_cast<std::uint64_t>(kLongest))), 1u);
    EXPECT_EQ(times.quantile(1), static_cast<double>(kLongest));
}

TEST(WakeUps, AreCountedOnceAPeriodAndJudgedByTheirLateness) {
    const WakeUps found = measure_wake_ups(1000, 0.2);
    EXPECT_EQ(found.late.count(), 200u);
    EXPECT_GE(found.late.largest(), found.late.quantile(0.5));
    WakeUps late;
    late.period = 1e-3;
    for (int i = 0; i < 1000; ++i)
        late.late.add(5'000);
    EXPECT_TRUE(late.punctual());
    for (int i = 0; i < 10; ++i)
        late.late.add(600'000); // one in a hundred, by more than half a period
    EXPECT_FALSE(late.punctual());
    late = {};
    late.period = 1e-3;
    late.lost = 1;
    EXPECT_FALSE(late.punctual());
}

} // namespace
} // namespace forceshade::device
