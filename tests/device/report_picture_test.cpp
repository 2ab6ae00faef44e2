// The end report's picture: texts that keep clear of each other, marks in their places, the same bytes.
#include <algorithm>
#include <clocale>
#include <cmath>
#include <random>

#include <gtest/gtest.h>

#include "device/report/live_picture.h"
#include "device/report/text.h"
#include "tests/device/report_cases.h"

namespace forceshade::device::test {
namespace {

using picture::Box;
using picture::Picture;

bool overlap(const Box& a, const Box& b) {
    return a.x < b.x + b.width && b.x < a.x + a.width && a.y < b.y + b.height && b.y < a.y + a.height;
}

std::size_t times_said(const Picture& picture, std::string_view part) {
    return static_cast<std::size_t>(
        std::count_if(picture.texts.begin(), picture.texts.end(),
                      [&](const picture::PlacedText& placed) { return placed.text.find(part) != std::string::npos; }));
}

void expect_readable(const Picture& picture) {
    EXPECT_EQ(picture.width, 1000);
    EXPECT_LT(picture.height, 1400);
    EXPECT_LT(picture.png.size(), 300'000u);
    for (std::size_t i = 0; i < picture.texts.size(); ++i) {
        const auto& [text, ink] = picture.texts[i];
        EXPECT_GE(ink.x, 1) << text;
        EXPECT_GE(ink.y, 1) << text;
        EXPECT_LE(ink.x + ink.width, picture.width - 1) << text;
        EXPECT_LE(ink.y + ink.height, picture.height - 1) << text;
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_FALSE(overlap(ink, picture.texts[j].ink)) << text << " over " << picture.texts[j].text;
    }
}

class EveryDrawnRun : public ::testing::TestWithParam<Case> {};

TEST_P(EveryDrawnRun, is_drawn_without_cut_or_overlapping_text) {
    expect_readable(draw_live_report(GetParam().outcome));
}

INSTANTIATE_TEST_SUITE_P(LivePicture, EveryDrawnRun, ::testing::ValuesIn(cases()),
                         [](const auto& tested) { return tested.param.file; });

TEST(LivePicture, marks_quantiles_and_the_period) {
    const Picture picture = draw_live_report(usual(1000));
    for (const char* label : {"p50 ", "p99 ", "p99.9 ", "largest "})
        EXPECT_EQ(times_said(picture, label), 3u) << label;
    for (const char* label : {"p50 424 ns", "period 1 ms", "bump.toml (f64), live at 1 kHz", "60000 samples in 60 s",
                              "1 µs", "100 µs", "share of the samples"})
        EXPECT_GE(times_said(picture, label), 1u) << label;
}

TEST(LivePicture, shows_no_lateness_as_fast_as_possible_and_says_so) {
    const Picture picture = draw_live_report(as_fast_as_possible());
    for (const char* label : {"jitter:", "late:", "period"})
        EXPECT_EQ(times_said(picture, label), 0u) << label;
    EXPECT_EQ(times_said(picture, "p50"), 1u);
    EXPECT_EQ(times_said(picture, "no sample is due at any time"), 1u);
}

TEST(LivePicture, says_where_there_are_no_samples) {
    EXPECT_EQ(times_said(draw_live_report(no_sample()), ": no samples"), 3u);
    EXPECT_EQ(times_said(draw_live_report(one_sample()), ": no samples"), 1u);
    EXPECT_EQ(times_said(draw_live_report(one_sample()), "largest 346 ns"), 1u);
}

// Times of any size and spread, so that the marks stand anywhere.
TEST(LivePicture, is_readable_wherever_its_marks_stand) {
    std::mt19937_64 random(11);
    for (int run = 0; run < 20; ++run) {
        LiveOutcome outcome = no_sample();
        outcome.rate = std::pow(10.0, 2 + static_cast<double>(random() % 3));
        outcome.real_time = run % 3 > 0;
        LoopCounts& counts = outcome.counts;
        for (Histogram* times : {&counts.computing, &counts.late, &counts.jitter}) {
            const auto shift = random() % 60, spread = 1 + random() % 12, count = 1 + random() % 2000;
            for (std::uint64_t i = 0; i < count; ++i)
                times->add(static_cast<std::int64_t>((random() >> (1 + random() % spread)) >> shift));
        }
        SCOPED_TRACE(run);
        expect_readable(draw_live_report(outcome));
    }
}

TEST(LivePicture, is_the_same_every_time_in_any_locale) {
    const auto first = draw_live_report(usual(4000)).png;
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    const auto second = draw_live_report(usual(4000)).png;
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(first, second);
    EXPECT_NE(first, draw_live_report(usual(1000)).png);
}

TEST(TimeBars, hold_every_time_once_side_by_side) {
    Histogram times;
    std::uint64_t count = 0;
    for (std::int64_t time = 0; time < 100'000'000; time = time + 1 + time / 100, ++count)
        times.add(time);
    std::uint64_t counted = 0, end = 0;
    for (const TimeBar& bar : time_bars(times, 20)) {
        EXPECT_EQ(bar.from, end) << "nothing between";
        EXPECT_LT(bar.from, bar.to);
        const double decades = std::log10(double(bar.to) / std::max(1.0, double(bar.from)));
        EXPECT_NEAR(decades, 0.05, bar.from > 100 ? 0.016 : 0.3);
        end = bar.to;
        counted += bar.count;
    }
    EXPECT_EQ(counted, count);
}

} // namespace
} // namespace forceshade::device::test
