#include "tests/picture/cases.h"

#include <algorithm>
#include <clocale>
#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <png.h>
#include <regex>

#include "host/mesh/mesh.h"
#include "host/picture/canvas.h"

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

/// A depth at which the force is a 20th of the largest.
Touch touch_of(const FieldSlice& slice) {
    return {1e-3, largest_of(values_of(slice, Quantity::magnitude)) / 20};
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
        expect_sound(draw_arrows({one.name}, slices.xz, touch_of(slices.xz), one.lines));
    }
}

TEST(Picture, SameInputSameBytesInAnyLocale) {
    const test::Case& usual = case_named("shaded");
    const auto draw = [&] {
        const test::Slices slices = test::collect(usual.grid, usual.law, true);
        return std::pair(draw_mosaic({usual.name}, slices.tiles).png,
                         draw_arrows({usual.name}, slices.xz, touch_of(slices.xz), usual.lines).png);
    };
    const auto first = draw();
    std::setlocale(LC_ALL, "de_DE.UTF-8");
    const auto second = draw();
    std::setlocale(LC_ALL, "C");
    EXPECT_EQ(first, second);
}

TEST(Picture, HoldsNoDateAndNoProgramName) {
    const test::Case& usual = case_named("shaded");
    const auto png = draw_arrows({""}, test::collect(usual.grid, usual.law, true).xz, {}).png;
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

// On the bump of 1000 N/m the force is 1 N at 1 mm below the facets.
TEST(Contours, LieAtTheDepthOfTheForceFromOneSideToTheOther) {
    const FieldSlice& slice = xz_of("unshaded");
    const auto lines = contours(slice, 1);
    ASSERT_EQ(lines.size(), 1U);
    const SliceAxes& axes = slice.axes;
    const double across = axes.u.back() - axes.u.front();
    EXPECT_NEAR(std::fabs(lines[0].back().u - lines[0].front().u), across, 1e-9);
    const double top = test::two_facet_lines().nominal[2].z, half_width = test::two_facet_lines().nominal[3].x;
    for (const ContourPoint& point : lines[0]) {
        const double x = axes.u[0] + point.u, surface = std::max(0.0, top * (1 - std::fabs(x) / half_width));
        EXPECT_NEAR(axes.v[0] + point.v, surface - 1e-3, 1e-4) << x;
        EXPECT_NEAR(axes.u[point.sample % axes.u.size()], x, 2e-4) << "its sample is next to it";
        EXPECT_NE(slice.force[point.sample][2], 0);
    }
}

TEST(Contours, AreClosedAroundASolidAndNoneWithoutItsForce) {
    FieldSlice slice{{{}, {}, 1, 1, 1, 0}, {}};
    for (int i = 0; i < 21; ++i)
        slice.axes.u.push_back(i), slice.axes.v.push_back(i);
    for (const double z : slice.axes.v)
        for (const double x : slice.axes.u) // two discs of radius 4
            slice.force.push_back(
                {0, std::max({0.0, 4 - std::hypot(x - 5, z - 5), 4 - std::hypot(x - 15, z - 14)}), 0});
    const auto lines = contours(slice, 1);
    ASSERT_EQ(lines.size(), 2U);
    for (const auto& line : lines) {
        EXPECT_EQ(line.front().u, line.back().u);
        EXPECT_EQ(line.front().v, line.back().v);
    }
    for (const ContourPoint& point : lines[0])
        EXPECT_NEAR(std::hypot(point.u - 5, point.v - 5), 3, 0.2);
    EXPECT_TRUE(contours(slice, 10).empty());
}

bool says(const Picture& picture, const std::string& words) {
    return std::ranges::any_of(picture.texts,
                               [&](const PlacedText& text) { return text.text.find(words) != std::string::npos; });
}

TEST(Picture, OfArrowsSaysWhereTheyStandAndWhichForcesLeaveThePlane) {
    const char *const along = "1 mm below the surface", *const out = "out of the plane by more than 60°";
    FieldSlice slice = xz_of("shaded");
    const Picture touched = draw_arrows({"A bump"}, slice, {1e-3, 1}),
                  deep = draw_arrows({"A bump"}, slice, {1e-3, 1e9});
    EXPECT_TRUE(says(touched, along));
    EXPECT_FALSE(says(touched, out));
    EXPECT_FALSE(says(deep, along));
    EXPECT_TRUE(says(deep, "direction of the force")) << "on a grid";
    for (auto& force : slice.force)
        force[1] = 3 * force[2];
    EXPECT_TRUE(says(draw_arrows({"A bump"}, slice, {1e-3, 1}), out));
}

struct DrawnArrow {
    Point tail, tip;
};

/// Of the vectors: white polygons of seven corners. The last is the legend's.
std::vector<DrawnArrow> arrows_of(const Picture& picture) {
    static const std::string corner = "([0-9.]+) ([0-9.]+) ", next = "L " + corner;
    static const std::regex arrow("fill:rgb\\(100%,100%,100%\\)[^>]*d=\"M " + corner + next + next + next + next +
                                  next + next + "Z");
    const std::string svg = picture.svg();
    std::vector<DrawnArrow> arrows;
    for (std::sregex_iterator it(svg.begin(), svg.end(), arrow), end; it != end; ++it) {
        const auto at = [&](std::size_t i) { return std::stod((*it)[i]); };
        arrows.push_back({{(at(1) + at(13)) / 2, (at(2) + at(14)) / 2}, {at(7), at(8)}});
    }
    return arrows;
}

TEST(Picture, OfArrowsHasThemOfEqualLengthAtEqualStepsAlongASlope) {
    const test::Law slope = [](double x, double, double z) { // half as steep as wide; on one side 45 degrees aside
        const double force = 1000 * std::max(0.0, x / 2 - z) / std::sqrt(x > 0 ? 2 : 1);
        return std::array<double, 3>{-force / 2, x > 0 ? std::hypot(force, force / 2) : 0.0, force};
    };
    const FieldSlice slice = test::collect({}, slope, true).xz;
    std::vector<DrawnArrow> arrows = arrows_of(draw_arrows({"A slope"}, slice, {1e-3, 1}));
    ASSERT_GT(arrows.size(), 10U);
    arrows.pop_back();
    const auto apart = [](Point a, Point b) { return std::hypot(b.x - a.x, b.y - a.y); };
    const double length = apart(arrows[0].tail, arrows[0].tip), step = apart(arrows[0].tail, arrows[1].tail);
    for (std::size_t i = 0; i < arrows.size(); ++i) {
        const auto& [tail, tip] = arrows[i];
        EXPECT_NEAR(apart(tail, tip), length, 0.05);
        EXPECT_NEAR((tip.x - tail.x) / (tail.y - tip.y), -0.5, 0.01) << "in the force's direction in the plane";
        EXPECT_NEAR(i == 0 ? step : apart(arrows[i - 1].tail, tail), step, 1) << i;
    }
}

TEST(Picture, KeepsToTheSizeThatIsAskedFor) {
    const test::Slices slices = test::collect(case_named("shaded").grid, case_named("shaded").law, true);
    for (const Look& look : {Look{"narrow", 700, 0}, Look{"flat", 1000, 420}, Look{"wide", 2400, 900}})
        for (const Picture& picture : {draw_mosaic(look, slices.tiles), draw_arrows(look, slices.xz, {1e-3, 1}),
                                       draw_shading(look, xz_of("unshaded"), slices.xz, {1e-3, 1})}) {
            expect_sound(picture, look.width);
            EXPECT_TRUE(look.most_height == 0 || picture.height <= look.most_height) << look.title;
        }
}

TEST(Picture, ShowsEveryQuantityInEveryPlane) {
    const test::Case& usual = case_named("textured");
    for (std::size_t q = 0; q < kQuantityNames.size(); ++q) {
        expect_sound(
            draw_arrows({"A bump"}, xz_of("textured"), {1e-3, 1}, {}, static_cast<Quantity>(q), xz_of("unshaded")));
    }
    for (const std::size_t axis : {0, 2}) {
        const test::Slices slices = test::collect(usual.grid, usual.law, false, {axis, 0.001, Quantity::magnitude});
        expect_sound(draw_arrows({"A bump"}, slices.xz, {1e-3, 1}));
    }
}

} // namespace
} // namespace forceshade::picture
