#include "host/picture/colours.h"
#include "tests/picture/cases.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
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
    const Picture mosaic = draw_mosaic({GetParam().name}, slices.tiles);
    const Picture arrows = draw_arrows({GetParam().name}, slices.xz, GetParam().lines);
    expect_sound(mosaic);
    expect_sound(arrows);
    EXPECT_TRUE(says(mosaic, "x / ") || says(mosaic, "(x "));
    EXPECT_TRUE(says(mosaic, "y / ") || says(mosaic, "(y "));
    EXPECT_TRUE(says(mosaic, "z = ") || says(mosaic, " m = "));
    EXPECT_TRUE(says(arrows, "z / ") || says(arrows, "(z "));
    const double largest = take_census(values_of(slices.xz, Quantity::magnitude).value).largest;
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
    EXPECT_TRUE(says(draw_mosaic({""}, nothing.tiles), "no force in this field"));
    EXPECT_TRUE(says(draw_mosaic({""}, nothing.tiles), "no force in this slice"));
    EXPECT_TRUE(says(draw_arrows({""}, nothing.xz), "no force in this slice"));
    const test::Case& broken = case_named("broken");
    const test::Slices some = test::collect(broken.grid, broken.law, true);
    EXPECT_TRUE(says(draw_arrows({""}, some.xz), "not a finite number (4480 of 32768 samples)"));
    const test::Case& hopeless = case_named("all_broken");
    const test::Slices none = test::collect(hopeless.grid, hopeless.law);
    EXPECT_TRUE(says(draw_mosaic({""}, none.tiles), "not a finite number (64 of 64 samples)"));
    EXPECT_TRUE(says(draw_arrows({""}, none.xz), "not a finite number (16 of 16 samples)"));
    EXPECT_FALSE(says(draw_arrows({""}, none.xz), "no force"));
}

TEST(Picture, SameInputSameBytesInAnyLocale) {
    const test::Case& usual = case_named("shaded");
    const auto draw = [&] {
        const test::Slices slices = test::collect(usual.grid, usual.law, true);
        return std::pair(draw_mosaic({usual.name}, slices.tiles).png,
                         draw_arrows({usual.name}, slices.xz, usual.lines).png);
    };
    const auto first = draw();
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    const auto second = draw();
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(first, second);
}

TEST(Picture, RepeatedRowsGiveTheSamePicture) {
    const test::Case& usual = case_named("shaded");
    EXPECT_EQ(draw_mosaic({""}, test::collect(usual.grid, usual.law, true).tiles).png,
              draw_mosaic({""}, test::collect(usual.grid, usual.law, false).tiles).png);
}

TEST(Picture, HoldsNoDateAndNoProgramName) {
    const test::Case& usual = case_named("shaded");
    const auto png = draw_arrows({""}, test::collect(usual.grid, usual.law, true).xz).png;
    for (const std::string_view chunk : {"tIME", "tEXt", "iTXt", "zTXt"})
        EXPECT_EQ(std::search(png.begin(), png.end(), chunk.begin(), chunk.end()), png.end()) << chunk;
}

ColourScale newtons(double largest) {
    return scale_for(Quantity::magnitude, largest, {0, 2, 1});
}

std::uint32_t viridis(double share) {
    return packed(colour_at(ColourMap::sequential, share));
}

TEST(Raster, ShowsTheNearestSampleWithTheLargestVOnTop) {
    const ValueSlice slice{{{0, 1}, {0, 1}, 1, 1, 1, 0}, {kNoForce, 1, 2, 4}};
    const auto pixels = rasterise(slice, 4, 4, newtons(4));
    EXPECT_EQ(pixels[0], viridis(0.5));            // (0, 1): 2 of 4 N
    EXPECT_EQ(pixels[3], viridis(1));              // (1, 1): 4 of 4 N
    EXPECT_EQ(pixels[12], packed(kNoForceColour)); // (0, 0): none
    EXPECT_EQ(pixels[4 * 2 + 2], viridis(0.25));   // (1, 0): 1 of 4 N
}

TEST(Raster, MarksWhatIsNoNumber) {
    const ValueSlice slice{{{0}, {0}, 1, 1, 1, 0}, {std::numeric_limits<double>::quiet_NaN()}};
    const auto pixels = rasterise(slice, 16, 16, newtons(1));
    for (const Rgb8 colour : kNonFiniteColours)
        EXPECT_NE(std::ranges::find(pixels, packed(colour)), pixels.end());
}

TEST(Raster, NoComponentHidesWhatIsNoNumber) {
    const double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
    for (const double bad : {nan, infinity, -infinity})
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const double other : {0.0, 1.0}) {
                FieldSlice slice{{{0}, {0}, 1, 1, 1, 0}, {{other, other, other}}};
                slice.force[0][axis] = bad;
                EXPECT_EQ(take_census(values_of(slice, Quantity::magnitude).value).non_finite, 1U)
                    << bad << " in " << axis;
            }
}

TEST(Raster, MagnitudesNeitherOverflowNorVanish) {
    const FieldSlice slice{{{0, 1}, {0}, 1, 1, 1, 0}, {{3e300, 0, 4e300}, {3e-310, 4e-310, 0}}};
    EXPECT_DOUBLE_EQ(values_of(slice, Quantity::magnitude).value[0], 5e300);
    EXPECT_NEAR(values_of(slice, Quantity::magnitude).value[1], 5e-310, 1e-320);
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
    const Decoded a = decode(draw_arrows({""}, plain.xz)), b = decode(draw_arrows({""}, shaded.xz));
    ASSERT_EQ(a.rgb.size(), b.rgb.size());
    std::size_t different = 0;
    for (std::size_t i = 0; i < a.rgb.size(); i += 3)
        different += a.rgb[i] != b.rgb[i];
    EXPECT_GT(different, 5000U);
}

TEST(Values, OfAForceInThePlaneOfTheSlice) {
    const std::array<double, 3> force{3, 7, -3}, unshaded{0, 0, 1};
    EXPECT_DOUBLE_EQ(value_of(Quantity::magnitude, force, {}, {0, 2, 1}), std::sqrt(67));
    EXPECT_EQ(value_of(Quantity::y, force, {}, {0, 2, 1}), 7);
    EXPECT_DOUBLE_EQ(value_of(Quantity::direction, force, {}, {0, 2, 1}), 135) << "from +z towards +x";
    EXPECT_DOUBLE_EQ(value_of(Quantity::angle, {1, 0, 0}, unshaded, {0, 2, 1}), 90);
    EXPECT_NEAR(value_of(Quantity::angle, {1e-9, 0, 1}, {0, 0, 5}, {0, 2, 1}), 5.7295779513e-8, 1e-17)
        << "small angles keep their digits";
    EXPECT_EQ(value_of(Quantity::angle, {}, unshaded, {0, 2, 1}), kNoForce);
    EXPECT_EQ(value_of(Quantity::angle, force, {}, {0, 2, 1}), kNoForce);
}

TEST(Values, AreCroppedToTheContactWithABorder) {
    ValueSlice slice{{{}, {0, 1, 2, 3, 4, 5, 6, 7, 8, 9}, 1, 1, 1, 0}, std::vector<double>(200, kNoForce)};
    for (int i = 0; i < 20; ++i)
        slice.axes.u.push_back(i);
    slice.value[5 * 20 + 7] = slice.value[6 * 20 + 11] = 1;
    const auto expect = [&](std::optional<std::array<double, 2>> reach, std::vector<double> v) {
        const ValueSlice part = cropped(slice, contact_window(std::span(&slice, 1), reach));
        EXPECT_EQ(part.axes.u, (std::vector<double>{6, 7, 8, 9, 10, 11, 12}));
        EXPECT_EQ(part.axes.v, v);
        EXPECT_EQ(std::ranges::count(part.value, 1), 2);
    };
    expect({}, {4, 5, 6, 7});
    expect(std::array{4.0, 8.0}, {3, 4, 5, 6, 7, 8, 9});
}

const FieldSlice& xz_of(const std::string& file) {
    static std::map<std::string, test::Slices> all;
    if (!all.contains(file))
        all[file] = test::collect(case_named(file).grid, case_named(file).law, true);
    return all[file].xz;
}

TEST(Shading, ShowsByHowMuchTheForceTurns) {
    const Picture picture = draw_shading({"A bump"}, xz_of("unshaded"), xz_of("shaded"), test::two_facet_lines());
    expect_sound(picture);
    EXPECT_TRUE(says(picture, "angle between unshaded and shaded force"));
    EXPECT_TRUE(says(picture, "angle / °"));
    // At the apex the unshaded normal leans by the slope of the facets, the shaded one not at all.
    EXPECT_TRUE(says(picture, "shading turns the force by up to 28."));
    EXPECT_TRUE(says(picture, "the magnitude stays"));
    const Picture same = draw_shading({"A bump"}, xz_of("shaded"), xz_of("shaded"));
    expect_sound(same);
    EXPECT_TRUE(says(same, "shading turns the force nowhere"));
    EXPECT_FALSE(says(same, "angle / °")) << "no scale without a value";
}

TEST(Mosaic, ShowsTheContactAlone) {
    const test::Case& usual = case_named("shaded");
    const test::Slices slices = test::collect(usual.grid, usual.law, true);
    const Picture picture = draw_mosaic({""}, slices.tiles);
    EXPECT_FALSE(says(picture, "no force in this slice"));
    EXPECT_FALSE(says(picture, "z = 8")) << "above the bump";
    EXPECT_TRUE(says(picture, "in 12 slices"));
}

TEST(Picture, KeepsToTheSizeThatIsAskedFor) {
    const test::Slices slices = test::collect(case_named("shaded").grid, case_named("shaded").law, true);
    for (const Look& look : {Look{"narrow", 700, 0}, Look{"flat", 1000, 420}, Look{"wide", 2400, 900}})
        for (const Picture& picture : {draw_mosaic(look, slices.tiles), draw_arrows(look, slices.xz),
                                       draw_shading(look, xz_of("unshaded"), slices.xz)}) {
            expect_sound(picture, look.width);
            EXPECT_TRUE(look.most_height == 0 || picture.height <= look.most_height) << look.title;
        }
}

TEST(Picture, ShowsEveryQuantityInEveryPlane) {
    const test::Case& usual = case_named("textured");
    for (std::size_t q = 0; q < kQuantityNames.size(); ++q) {
        const Picture picture =
            draw_arrows({"A bump"}, xz_of("textured"), {}, static_cast<Quantity>(q), xz_of("unshaded"));
        expect_sound(picture);
        EXPECT_TRUE(says(picture, q < 4 ? "N" : "°"));
    }
    for (const std::size_t axis : {0, 2}) {
        const test::Slices slices = test::collect(usual.grid, usual.law, false, {axis, 0.001, Quantity::magnitude});
        const Picture picture = draw_arrows({"A bump"}, slices.xz);
        expect_sound(picture);
        EXPECT_TRUE(says(picture, axis == 0 ? "y–z slice at x = 1 mm" : "x–y slice at z = 1 mm"));
        EXPECT_TRUE(says(picture, axis == 0 ? "(Fy, Fz)" : "(Fx, Fy)"));
    }
}

} // namespace
} // namespace forceshade::picture
