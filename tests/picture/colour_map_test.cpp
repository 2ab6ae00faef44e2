// The colours of numbers: those of d3, whose page shows the same volumes.
#include "host/picture/colours.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace forceshade::picture {
namespace {

// Relative luminance by sRGB (IEC 61966-2-1).
double luminance(Rgb8 colour) {
    const auto linear = [](std::uint8_t c) {
        return c <= 10 ? c / 255.0 / 12.92 : std::pow((c / 255.0 + 0.055) / 1.055, 2.4);
    };
    return 0.2126 * linear(colour.r) + 0.7152 * linear(colour.g) + 0.0722 * linear(colour.b);
}

int distance(Rgb8 a, Rgb8 b) {
    return std::max({std::abs(a.r - b.r), std::abs(a.g - b.g), std::abs(a.b - b.b)});
}

TEST(ColourMap, IsThatOfThePage) {
    EXPECT_EQ(colour_at(ColourMap::sequential, 0), (Rgb8{0x44, 0x01, 0x54}));
    EXPECT_EQ(colour_at(ColourMap::sequential, 1), (Rgb8{0xfd, 0xe7, 0x25}));
    EXPECT_EQ(colour_at(ColourMap::second, 0), (Rgb8{0x0d, 0x08, 0x87}));
    EXPECT_EQ(colour_at(ColourMap::diverging, 0), (Rgb8{5, 48, 97})) << "d3.interpolateRdBu(1)";
    EXPECT_EQ(colour_at(ColourMap::diverging, 1), (Rgb8{103, 0, 31})) << "d3.interpolateRdBu(0)";
    EXPECT_EQ(colour_at(ColourMap::diverging, 0.5), (Rgb8{242, 239, 238})) << "d3.interpolateRdBu(0.5)";
    EXPECT_EQ(colour_at(ColourMap::cyclic, 0), (Rgb8{110, 64, 170})) << "d3.interpolateRainbow(0)";
    EXPECT_LE(distance(colour_at(ColourMap::cyclic, 0), colour_at(ColourMap::cyclic, 1)), 1);
}

TEST(ColourMap, IsReadInGrey) {
    for (const ColourMap map : {ColourMap::sequential, ColourMap::second})
        for (int i = 4; i < 256; i += 4)
            EXPECT_GT(luminance(colour_at(map, i / 256.0)), luminance(colour_at(map, (i - 4) / 256.0))) << i;
}

TEST(ColourMap, HasNoStepsAndNoPaper) {
    for (const ColourMap map : {ColourMap::sequential, ColourMap::second, ColourMap::diverging, ColourMap::cyclic})
        for (int i = 1; i < 256; ++i) {
            EXPECT_LE(distance(colour_at(map, i / 255.0), colour_at(map, (i - 1) / 255.0)), 8) << i;
            EXPECT_NE(colour_at(map, i / 255.0), kNoForceColour);
        }
}

} // namespace
} // namespace forceshade::picture
