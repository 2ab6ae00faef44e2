#include "host/picture/colour_map.h"
#include "host/picture/raster.h"
#include "tests/picture/cases.h"

#include <algorithm>
#include <clocale>
#include <gtest/gtest.h>
#include <png.h>

namespace forceshade::picture {
namespace {

struct Decoded {
    int width = 0, height = 0;
    std::vector<std::uint8_t> rgb;
};

Decoded decode(const Picture& picture) {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    Decoded decoded;
    if (!png_image_begin_read_from_memory(&image, picture.png.data(), picture.png.size()))
        return decoded;
    image.format = PNG_FORMAT_RGB;
    decoded.rgb.resize(PNG_IMAGE_SIZE(image));
    if (png_image_finish_read(&image, nullptr, decoded.rgb.data(), 0, nullptr)) {
        decoded.width = static_cast<int>(image.width);
        decoded.height = static_cast<int>(image.height);
    }
    return decoded;
}

void expect_sound(const Picture& picture, int width = 1400) {
    const Decoded decoded = decode(picture);
    EXPECT_EQ(decoded.width, picture.width);
    EXPECT_EQ(decoded.height, picture.height);
    EXPECT_EQ(picture.width, width);
    EXPECT_GT(picture.height, 200);
    EXPECT_LT(picture.height, 1400);
    EXPECT_LT(picture.png.size(), 500'000U);
    for (std::size_t i = 0; i < picture.texts.size(); ++i) {
        const auto& [text, ink] = picture.texts[i];
        EXPECT_GE(ink.x, 1) << text;
        EXPECT_GE(ink.y, 1) << text;
        EXPECT_LE(ink.x + ink.width, picture.width - 1) << text;
        EXPECT_LE(ink.y + ink.height, picture.height - 1) << text;
        for (std::size_t j = 0; j < i; ++j)
            EXPECT_FALSE(test::texts_overlap(ink, picture.texts[j].ink)) << text << " over " << picture.texts[j].text;
    }
}

bool says(const Picture& picture, std::string_view part) {
    return std::any_of(picture.texts.begin(), picture.texts.end(),
                       [&](const PlacedText& placed) { return placed.text.find(part) != std::string::npos; });
}

class EveryCase : public ::testing::TestWithParam<test::Case> {};

TEST_P(EveryCase, IsDrawnWithoutCutOrOverlappingText) {
    const test::Slices slices = test::collect(GetParam().grid, GetParam().law);
    const Picture mosaic = draw_mosaic(GetParam().name, slices.tiles);
    const Picture arrows = draw_arrows(GetParam().name, slices.xz, GetParam().lines);
    expect_sound(mosaic);
    expect_sound(arrows);
    EXPECT_TRUE(says(mosaic, "x / ") || says(mosaic, "(x "));
    EXPECT_TRUE(says(mosaic, "y / ") || says(mosaic, "(y "));
    EXPECT_TRUE(says(mosaic, "z = ") || says(mosaic, " m = "));
    EXPECT_TRUE(says(arrows, "z / ") || says(arrows, "(z "));
    const double largest = take_census(magnitude_of(slices.xz).magnitude).largest;
    EXPECT_EQ(says(arrows, "force magnitude / "), largest > 0);
    EXPECT_EQ(says(arrows, "in-plane force of "), largest > 0);
}

INSTANTIATE_TEST_SUITE_P(Picture, EveryCase, ::testing::ValuesIn(test::cases()),
                         [](const auto& tested) { return tested.param.file; });

const test::Case& case_named(const std::string& file) {
    static const std::vector<test::Case> all = test::cases();
    return *std::find_if(all.begin(), all.end(), [&](const test::Case& one) { return one.file == file; });
}

TEST(Picture, SaysWhereThereIsNoForceOrNoNumber) {
    const test::Case& empty = case_named("no_force");
    const test::Slices nothing = test::collect(empty.grid, empty.law, true);
    EXPECT_TRUE(says(draw_mosaic("", nothing.tiles), "no force in this field"));
    EXPECT_TRUE(says(draw_mosaic("", nothing.tiles), "no force in this slice"));
    EXPECT_TRUE(says(draw_arrows("", nothing.xz), "no force in this slice"));
    const test::Case& broken = case_named("broken");
    const test::Slices some = test::collect(broken.grid, broken.law, true);
    EXPECT_TRUE(says(draw_arrows("", some.xz), "not a finite number (4480 of 32768 samples)"));
    const test::Case& hopeless = case_named("all_broken");
    const test::Slices none = test::collect(hopeless.grid, hopeless.law);
    EXPECT_TRUE(says(draw_mosaic("", none.tiles), "not a finite number (64 of 64 samples)"));
    EXPECT_TRUE(says(draw_arrows("", none.xz), "not a finite number (16 of 16 samples)"));
    EXPECT_FALSE(says(draw_arrows("", none.xz), "no force"));
}

TEST(Picture, SameInputSameBytesInAnyLocale) {
    const test::Case& usual = case_named("shaded");
    const auto draw = [&] {
        const test::Slices slices = test::collect(usual.grid, usual.law, true);
        return std::pair(draw_mosaic(usual.name, slices.tiles).png,
                         draw_arrows(usual.name, slices.xz, usual.lines).png);
    };
    const auto first = draw();
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    const auto second = draw();
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(first, second);
}

TEST(Picture, RepeatedRowsGiveTheSamePicture) {
    const test::Case& usual = case_named("shaded");
    EXPECT_EQ(draw_mosaic("", test::collect(usual.grid, usual.law, true).tiles).png,
              draw_mosaic("", test::collect(usual.grid, usual.law, false).tiles).png);
}

TEST(Picture, HoldsNoDateAndNoProgramName) {
    const test::Case& usual = case_named("shaded");
    const auto png = draw_arrows("", test::collect(usual.grid, usual.law, true).xz).png;
    for (const std::string_view chunk : {"tIME", "tEXt", "iTXt", "zTXt"})
        EXPECT_EQ(std::search(png.begin(), png.end(), chunk.begin(), chunk.end()), png.end()) << chunk;
}

std::uint32_t packed(Rgb8 c) {
    return static_cast<std::uint32_t>((c.r << 16) | (c.g << 8) | c.b);
}

TEST(Raster, ShowsTheNearestSampleWithTheLargestVOnTop) {
    const MagnitudeSlice slice{{{0, 1}, {0, 1}, 1, 1, 1, 0}, {0, 1, 2, 4}};
    const auto pixels = rasterise(slice, 4, 4, 4);
    EXPECT_EQ(pixels[0], packed(force_colours()[128])); // (0, 1): 2 of 4 N
    EXPECT_EQ(pixels[3], packed(force_colours()[255])); // (1, 1): 4 of 4 N
    EXPECT_EQ(pixels[12], packed(kNoForceColour));      // (0, 0): none
    EXPECT_EQ(pixels[15], packed(force_colours()[64])); // (1, 0): 1 of 4 N
    EXPECT_EQ(pixels[4 * 1 + 1], packed(force_colours()[128]));
    EXPECT_EQ(pixels[4 * 2 + 2], packed(force_colours()[64]));
}

TEST(Raster, MarksWhatIsNoNumber) {
    const MagnitudeSlice slice{{{0}, {0}, 1, 1, 1, 0}, {std::numeric_limits<double>::infinity()}};
    const auto pixels = rasterise(slice, 16, 16, 1);
    EXPECT_NE(std::find(pixels.begin(), pixels.end(), packed(kNonFiniteColours[0])), pixels.end());
    EXPECT_NE(std::find(pixels.begin(), pixels.end(), packed(kNonFiniteColours[1])), pixels.end());
}

TEST(Raster, NoComponentHidesWhatIsNoNumber) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinity, -infinity})
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const double other : {0.0, 1.0}) {
                FieldSlice slice{{{0}, {0}, 1, 1, 1, 0}, {{other, other, other}}};
                slice.force[0][axis] = bad;
                EXPECT_EQ(take_census(magnitude_of(slice).magnitude).non_finite, 1U) << bad << " in " << axis;
            }
}

TEST(Raster, MagnitudesNeitherOverflowNorVanish) {
    const FieldSlice slice{{{0, 1}, {0}, 1, 1, 1, 0}, {{3e300, 0, 4e300}, {3e-310, 4e-310, 0}}};
    EXPECT_DOUBLE_EQ(magnitude_of(slice).magnitude[0], 5e300);
    EXPECT_NEAR(magnitude_of(slice).magnitude[1], 5e-310, 1e-320);
}

TEST(Raster, EverySampleGetsItsShareOfPixels) {
    const std::vector<double> samples{1000, 1000.1, 1000.2, 1000.3};
    const auto nearest = nearest_samples(samples, 0.1, 400);
    for (std::size_t sample = 0; sample < samples.size(); ++sample)
        EXPECT_NEAR(static_cast<double>(std::count(nearest.begin(), nearest.end(), sample)), 100, 1);
}

// The two shapes of the drawn field must show in the arrows: the plot of the shaded bump differs from the unshaded one
// although their magnitudes are equal.
TEST(Picture, ArrowsShowTheDirection) {
    const test::Slices plain = test::collect(case_named("unshaded").grid, case_named("unshaded").law, true);
    const test::Slices shaded = test::collect(case_named("shaded").grid, case_named("shaded").law, true);
    const Decoded a = decode(draw_arrows("", plain.xz)), b = decode(draw_arrows("", shaded.xz));
    ASSERT_EQ(a.rgb.size(), b.rgb.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3)
        different += a.rgb[i] != b.rgb[i];
    EXPECT_GT(different, 5000U);
}

TEST(SideBySide, TwoSlicesToOneScale) {
    const test::Case bump = test::cases().front();
    const auto weak = test::collect(bump.grid, test::two_facet_bump(500, false));
    const auto strong = test::collect(bump.grid, test::two_facet_bump(1000, true));
    const Picture picture = draw_side_by_side({"weak", weak.xz}, {"strong", strong.xz}, bump.lines);
    expect_sound(picture, 2800);
    EXPECT_TRUE(says(picture, "weak") && says(picture, "strong"));
    const auto notes = [](const Picture& drawn) {
        std::vector<std::string> texts;
        for (const PlacedText& placed : drawn.texts)
            if (placed.text.find("at most") != std::string::npos)
                texts.push_back(placed.text);
        return texts;
    };
    // Both name the largest force of the two.
    const auto both = notes(picture), alone = notes(draw_arrows("strong", strong.xz, bump.lines));
    ASSERT_EQ(both.size(), 2U);
    EXPECT_EQ(both[0], alone.at(0));
    EXPECT_EQ(both[1], alone.at(0));
}

} // namespace
} // namespace forceshade::picture
