// Axes: where numbers lie, and what stands at their ticks.
#include <cmath>

#include <gtest/gtest.h>

#include "host/plot/scale.h"

namespace forceshade::plot {
namespace {

std::vector<std::string> labels(const Scale& scale, std::size_t most) {
    std::vector<std::string> texts;
    for (const Tick& tick : scale.ticks(most))
        if (!tick.label.empty())
            texts.push_back(tick.label);
    return texts;
}

TEST(NumberLabels, AreForReaders) {
    EXPECT_EQ(number_label(0), "0");
    EXPECT_EQ(number_label(0.25), "0.25");
    EXPECT_EQ(number_label(-3), "−3");
    EXPECT_EQ(number_label(1234.5678, 5), "1234.6");
    EXPECT_EQ(number_label(1.5e-7), "1.5×10⁻⁷");
    EXPECT_EQ(number_label(1e-7), "10⁻⁷");
    EXPECT_EQ(number_label(2.5e12), "2.5×10¹²");
}

TEST(LogarithmicScales, HaveTicksAtPowersOfTen) {
    EXPECT_EQ(labels(Scale({1e-4, 10}, true), 8),
              (std::vector<std::string>{"10⁻⁴", "10⁻³", "10⁻²", "10⁻¹", "1", "10"}));
    EXPECT_EQ(labels(Scale({1e-12, 1e12}, true), 8).size(), 7u);
    EXPECT_EQ(labels(Scale({0.9, 7}, true), 8), (std::vector<std::string>{"1", "2", "5"}));
    EXPECT_GE(labels(Scale({3.1, 3.4}, true), 8).size(), 2u);
}

TEST(LinearScales, HaveTicksAtRoundNumbers) {
    EXPECT_EQ(labels(Scale({0, 1}, false), 6), (std::vector<std::string>{"0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
    EXPECT_EQ(labels(Scale({0, 4e-7}, false), 5),
              (std::vector<std::string>{"0", "1×10⁻⁷", "2×10⁻⁷", "3×10⁻⁷", "4×10⁻⁷"}));
}

TEST(Ranges, HoldEveryNumberAndAreNeverEmpty) {
    for (const bool logarithmic : {false, true})
        for (const std::vector<double>& values : {std::vector<double>{},
                                                  {0},
                                                  {-1, 0},
                                                  {5},
                                                  {1e9, 1e9 + 1e-9},
                                                  {1e-300, 1e300},
                                                  {-2, -1},
                                                  {3, 4},
                                                  {1e-308, 1e-308},
                                                  {1.7e308, 1e308}}) {
            const Range range = range_of(values, logarithmic);
            EXPECT_LT(range.low, range.high);
            EXPECT_TRUE(std::isfinite(range.low) && std::isfinite(range.high));
            EXPECT_TRUE(!logarithmic || range.low > 0);
            EXPECT_LT(Scale(range, logarithmic).ticks(8).size(), 200u);
            for (const double value : values)
                if (!logarithmic || (value > 1e-307 && value < 1e307)) {
                    EXPECT_GE(Scale(range, logarithmic).fraction(value), 0);
                    EXPECT_LE(Scale(range, logarithmic).fraction(value), 1);
                }
        }
}

} // namespace
} // namespace forceshade::plot
