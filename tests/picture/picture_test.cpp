#include "tests/picture/cases.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <png.h>

#include "host/mesh/mesh.h"

namespace forceshade::picture {
namespace {

/// Its pixels, row by row.
std::vector<std::uint8_t> decode(const Picture& picture, png_image& image) {
    image.version = PNG_IMAGE_VERSION;
    EXPECT_TRUE(png_image_begin_read_from_memory(&image, picture.png.data(), picture.png.size()));
    image.format = PNG_FORMAT_RGB;
    std::vector<std::uint8_t> pixels(PNG_IMAGE_SIZE(image));
    EXPECT_TRUE(png_image_finish_read(&image, nullptr, pixels.data(), 0, nullptr));
    return pixels;
}

void expect_sound(const Picture& picture, int width = 1400) {
    png_image image{};
    decode(picture, image);
    EXPECT_EQ(static_cast<int>(image.width), picture.width);
    EXPECT_EQ(static_cast<int>(image.height), picture.height);
    EXPECT_EQ(picture.width, width);
    EXPECT_GT(picture.height, 200);
    EXPECT_LT(picture.height, 1400);
    EXPECT_LT(picture.png.size(), 500'000U);
    test::expect_clear_texts(picture);
}

const test::Case& case_named(const std::string& file) {
    static const std::vector<test::Case> all = test::cases();
    return *std::find_if(all.begin(), all.end(), [&](const test::Case& one) { return one.file == file; });
}

TEST(Picture, OfAMeshUnderShadingsIsClearFromAnywhere) {
    PolygonSoup tetrahedron;
    tetrahedron.vertices = {{0, 0, 0}, {0.02, 0, 0}, {0, 0.03, 0}, {0, 0, 0.01}};
    tetrahedron.corners = {0, 2, 1, 0, 1, 3, 0, 3, 2, 1, 2, 3};
    tetrahedron.begins = {0, 3, 6, 9, 12};
    const Mesh mesh = prepare_mesh(tetrahedron, {}, VertexNormals::plain);
    std::vector<TurnedMesh> shadings{{"none", 1, std::vector<float>(4)}};
    for (const float most : {3.0F, 70.0F, 20.0F}) {
        shadings.push_back({"mean_value", 2, std::vector<float>(16, most)});
        for (const int width : {1400, 700})
            for (const std::array<double, 3> view : {kView, {0, 0, 1}, {0, 0, -1}, {1e-300, 5, 0}}) {
                const Picture picture = draw_turns({"A tetrahedron", width}, {}, mesh, shadings, view);
                EXPECT_EQ(picture.width, width);
                test::expect_clear_texts(picture);
            }
    }
    EXPECT_LE(draw_turns({"Low", 1400, 700}, {}, mesh, shadings).height, 700);
    test::expect_clear_texts(draw_turns({"Still"}, {}, mesh, std::span(shadings).first(1)));
}

// A square seen from above, which fills its panes: letters are grey, the mesh is not.
TEST(Picture, OfAMeshHasNoTitleOverIt) {
    PolygonSoup square;
    square.vertices = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
    square.corners = {0, 1, 2, 3};
    square.begins = {0, 4};
    const Mesh mesh = prepare_mesh(square, {}, VertexNormals::plain);
    const std::vector<TurnedMesh> shadings{{"none", 1, {0, 0}}, {"mean_value", 1, {20, 20}}, {"two_pass", 1, {9, 9}}};
    const Picture picture = draw_turns({"A square"}, {}, mesh, shadings, {0, 0, 1});
    png_image image{};
    const std::vector<std::uint8_t> pixels = decode(picture, image);
    std::size_t titles = 0;
    for (const auto& [text, ink] : picture.texts) {
        if (text.find(": ") == std::string::npos)
            continue;
        ++titles;
        for (int y = int(ink.y); y < int(ink.y + ink.height); ++y)
            for (int x = int(ink.x); x < int(ink.x + ink.width); ++x) {
                const std::uint8_t* const rgb = &pixels[3 * (std::size_t(y) * image.width + std::size_t(x))];
                ASSERT_LE(std::abs(rgb[0] - rgb[2]), 8) << text << " at " << x << ", " << y;
            }
    }
    EXPECT_EQ(titles, shadings.size());
}

TEST(Picture, OfEveryCaseHasNoTextThatIsCutOrDrawnOver) {
    for (const test::Case& one : test::cases()) {
        SCOPED_TRACE(one.file);
        const test::Slices slices = test::collect(one.grid, one.law);
        expect_sound(draw_mosaic({one.name}, slices.tiles));
        expect_sound(draw_arrows({one.name}, slices.xz, one.lines));
    }
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

TEST(Picture, HoldsNoDateAndNoProgramName) {
    const test::Case& usual = case_named("shaded");
    const auto png = draw_arrows({""}, test::collect(usual.grid, usual.law, true).xz).png;
    for (const std::string_view chunk : {"tIME", "tEXt", "iTXt", "zTXt"})
        EXPECT_EQ(std::search(png.begin(), png.end(), chunk.begin(), chunk.end()), png.end()) << chunk;
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

TEST(Values, OfForcesAreColouredUpToTheFullScale) {
    const ColourScale deep = scale_for(Quantity::magnitude, 16.7, {0, 2, 1}, 2),
                      part = scale_for(Quantity::x, 1, {0, 2, 1}, 2);
    EXPECT_EQ(deep.high, 2);
    EXPECT_EQ(largest_note(deep, 16.7), " (at most 16.7 N; the colours end at 2 N)");
    EXPECT_EQ(part.high, 1);
    EXPECT_EQ(largest_note(part, 1), " (at most 1 N)");
    EXPECT_EQ(scale_for(Quantity::angle, 30, {0, 2, 1}, 2).high, 30);
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
        expect_sound(draw_arrows({"A bump"}, xz_of("textured"), {}, static_cast<Quantity>(q), xz_of("unshaded")));
    }
    for (const std::size_t axis : {0, 2}) {
        const test::Slices slices = test::collect(usual.grid, usual.law, false, {axis, 0.001, Quantity::magnitude});
        expect_sound(draw_arrows({"A bump"}, slices.xz));
    }
}

} // namespace
} // namespace forceshade::picture
