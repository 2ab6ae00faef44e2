#include "host/picture/frame.h"

#include <gtest/gtest.h>

namespace forceshade::picture {
namespace {

SliceAxes line_of(double first, double spacing, std::size_t count) {
    SliceAxes axes{{}, {}, spacing, spacing, spacing, 0};
    for (std::size_t i = 0; i < count; ++i)
        axes.u.push_back(first + spacing * static_cast<double>(i));
    axes.v = axes.u;
    return axes;
}

// Labels are centred on their ticks: each must end before the next begins, however short the axis.
TEST(FitAxis, LabelsKeepClearOfEachOther) {
    for (const SliceAxes& samples :
         {line_of(-0.025, 2e-4, 256), line_of(-123.4567, 1.1e-2, 90), line_of(5e3, 10, 40)}) {
        const PlaneAxes axes = plan_axes(samples);
        for (double pixels = 8; pixels < 1300; pixels *= 1.15) {
            const Axis across = fit_axis(pixels, false, axes.across), up = fit_axis(pixels, true, axes.up);
            ASSERT_FALSE(across.ticks.empty() || up.ticks.empty());
            const auto gap = [&](const Axis& axis, std::size_t i) {
                return (axis.ticks[i].fraction - axis.ticks[i - 1].fraction) * pixels;
            };
            const TextStyle style{kSmallTextSize};
            for (std::size_t i = 1; i < across.ticks.size(); ++i)
                EXPECT_GE(
                    gap(across, i),
                    (measure(across.ticks[i - 1].label, style).width + measure(across.ticks[i].label, style).width) / 2)
                    << pixels;
            for (std::size_t i = 1; i < up.ticks.size(); ++i)
                EXPECT_GE(gap(up, i), measure("0", style).height - 1e-9) << pixels;
            if (pixels > 150) {
                EXPECT_GE(across.ticks.size(), 2U) << pixels;
                EXPECT_GE(up.ticks.size(), 2U) << pixels;
            }
        }
    }
}

TEST(PlaneAxes, KeepTheTrueAspectOrSaySo) {
    SliceAxes samples = line_of(0, 1e-3, 70);
    samples.v.resize(10);
    const PlaneAxes plain = plan_axes(samples);
    EXPECT_NEAR(plain.aspect, 1.0 / 7, 1e-9);
    EXPECT_TRUE(plain.stretch_note.empty());
    samples.v.resize(1);
    const PlaneAxes stretched = plan_axes(samples);
    EXPECT_NEAR(stretched.aspect, 1.0 / 8, 1e-9);
    EXPECT_EQ(stretched.stretch_note, "not to scale: z is stretched 8.75 times");
}

TEST(Heading, LongNamesAreWrappedShrunkAndAtLastCut) {
    EXPECT_EQ(plan_heading({"bump"}, {"note"}).name_style.size, kTitleSize);
    const Heading longer = plan_heading({std::string(150, 'W')}, {"note"});
    EXPECT_EQ(longer.name_style.size, kTextSize);
    EXPECT_LE(longer.name.size(), 3U);
    const Heading endless = plan_heading({std::string(100'000, 'W')}, {"note"});
    EXPECT_LE(endless.name.size(), 5U);
    EXPECT_TRUE(endless.name.back().ends_with("…"));
    for (const Heading& heading : {longer, endless})
        for (const std::string& line : heading.name)
            EXPECT_LE(measure(line, heading.name_style).width, Look{}.width - 2 * kMargin);
}

} // namespace
} // namespace forceshade::picture
