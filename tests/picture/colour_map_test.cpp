#include "host/picture/colour_map.h"

#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

namespace forceshade::picture {
namespace {

double distance(const Oklab& a, const Oklab& b) {
    return std::hypot(a.L - b.L, a.a - b.a, a.b - b.b);
}

double decode(std::uint8_t value) {
    const double gamma = value / 255.0;
    return gamma <= 0.04045 ? gamma / 12.92 : std::pow((gamma + 0.055) / 1.055, 2.4);
}

LinearRgb linear(Rgb8 c) {
    return {decode(c.r), decode(c.g), decode(c.b)};
}

// Vienot, Brettel, Mollon 1999: what a protanope or deuteranope sees, in linear sRGB.
LinearRgb protanope(const LinearRgb& c) {
    const double both = 0.11238 * c.r + 0.88762 * c.g;
    return {both, both, 0.00401 * c.r - 0.00401 * c.g + c.b};
}
LinearRgb deuteranope(const LinearRgb& c) {
    const double both = 0.29275 * c.r + 0.70725 * c.g;
    return {both, both, -0.02234 * c.r + 0.02234 * c.g + c.b};
}

TEST(ColourMap, NeighboursAreOneDistanceApart) {
    const auto& map = force_colours_oklab();
    const double mean = distance(map[0], map[1]);
    for (std::size_t i = 1; i < map.size(); ++i)
        EXPECT_NEAR(distance(map[i - 1], map[i]) / mean, 1, 0.02) << i;
    EXPECT_GT(mean * (kColourCount - 1), 0.7); // and the whole way is long: many colours to tell apart
}

TEST(ColourMap, LiesInGamut) {
    for (const Oklab& colour : force_colours_oklab()) {
        const LinearRgb rgb = to_linear_rgb(colour);
        for (const double component : {rgb.r, rgb.g, rgb.b}) {
            EXPECT_GE(component, 0);
            EXPECT_LE(component, 1);
        }
    }
}

TEST(ColourMap, LightnessIncreasesAlsoInGreyScale) {
    const auto luminance = [](Rgb8 c) {
        const LinearRgb rgb = linear(c);
        return 0.2126 * rgb.r + 0.7152 * rgb.g + 0.0722 * rgb.b;
    };
    const auto& exact = force_colours_oklab();
    const auto& rounded = force_colours();
    for (std::size_t i = 1; i < kColourCount; ++i)
        EXPECT_GT(exact[i].L, exact[i - 1].L) << i;
    for (std::size_t i = 2; i < kColourCount; ++i) // one step may be lost to rounding
        EXPECT_GT(luminance(rounded[i]), luminance(rounded[i - 2])) << i;
}

TEST(ColourMap, RoundingKeepsTheColours) {
    for (std::size_t i = 0; i < kColourCount; ++i)
        EXPECT_LT(distance(to_oklab(force_colours()[i]), force_colours_oklab()[i]), 0.01) << i;
    for (std::size_t i = 32; i < kColourCount; i += 32) {
        const double exact = distance(force_colours_oklab()[i - 32], force_colours_oklab()[i]);
        EXPECT_NEAR(distance(to_oklab(force_colours()[i - 32]), to_oklab(force_colours()[i])) / exact, 1, 0.05);
    }
}

TEST(ColourMap, GoesFromDarkBlueVioletToLightYellow) {
    const Rgb8 first = force_colours().front(), last = force_colours().back();
    EXPECT_GT(first.b, first.r);
    EXPECT_GT(first.r, first.g);
    EXPECT_LT(first.b, 90);
    EXPECT_GT(last.r, 240);
    EXPECT_GT(last.g, 220);
    EXPECT_LT(last.b, 120);
}

TEST(ColourMap, IsReadableWithoutRedGreenVision) {
    for (const auto& seen : {protanope, deuteranope})
        for (std::size_t i = 16; i < kColourCount; i += 16) {
            const Oklab a = to_oklab(to_rgb8(seen(linear(force_colours()[i - 16]))));
            const Oklab b = to_oklab(to_rgb8(seen(linear(force_colours()[i]))));
            EXPECT_GT(distance(a, b), 0.6 * distance(force_colours_oklab()[i - 16], force_colours_oklab()[i])) << i;
        }
}

TEST(ColourMap, NoForceAndNonFiniteStandApart) {
    for (const Rgb8 special : {kNoForceColour, kNonFiniteColours[0]})
        for (const Rgb8 colour : force_colours())
            EXPECT_GT(distance(to_oklab(special), to_oklab(colour)), 0.12);
    EXPECT_GT(distance(to_oklab(kNoForceColour), to_oklab(force_colours().front())), 0.7); // where they touch
}

TEST(ColourMap, IndexCoversTheWholeMap) {
    EXPECT_EQ(colour_index(1e-300, 5), 0U);
    EXPECT_EQ(colour_index(2.5, 5), kColourCount / 2);
    EXPECT_EQ(colour_index(5, 5), kColourCount - 1);
    EXPECT_EQ(colour_index(5e-324, 5e-324), kColourCount - 1);
    EXPECT_EQ(colour_index(1.7e308, 1.7e308), kColourCount - 1);
}

} // namespace
} // namespace forceshade::picture
