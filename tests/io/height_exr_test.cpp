#include <cmath>
#include <limits>

#include <gtest/gtest.h>

#include "host/error.h"
#include "host/io/height_image.h"
#include "tests/io/folder.h"
#include "tests/io/picture.h"

namespace forceshade {
namespace {

using testing::ExrChannel;
using testing::ExrKind;
using testing::Folder;
using testing::message_of;
using testing::write_exr;

double ramp(int x, int y) {
    return 0.5 * x + 10 * y;
} // exact as half
double other(int x, int y) {
    return x - y;
}

std::vector<double> expected_ramp(double scale = 1.0) {
    std::vector<double> samples;
    for (int y = 0; y < 3; ++y)
        for (int x = 0; x < 4; ++x)
            samples.push_back(ramp(x, y) / scale);
    return samples;
}

TEST(HeightExr, takes_floats_and_halves_as_they_are) {
    const Folder folder;
    for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF})
        for (const bool tiled : {false, true})
            for (const Imf::Compression compression :
                 {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION, Imf::PIZ_COMPRESSION}) {
                write_exr(folder / "u.exr", {{"Y", {type, ramp}}}, {.compression = compression, .tiled = tiled});
                const HeightImage image = read_height_image(folder / "u.exr");
                EXPECT_EQ(image.columns, 4u);
                EXPECT_EQ(image.rows, 3u);
                EXPECT_EQ(image.samples, expected_ramp());
                EXPECT_EQ(image.sha256.size(), 64u);
            }
}

TEST(HeightExr, takes_integers_as_fractions_of_full_scale) {
    const Folder folder;
    write_exr(folder / "u.exr", {{"height", {Imf::UINT, [](int x, int) { return x == 1 ? 4294967295.0 : x; }}}});
    EXPECT_EQ(read_height_image(folder / "u.exr").samples[1], 1.0);
    EXPECT_EQ(read_height_image(folder / "u.exr").samples[2], 2.0 / 4294967295.0);
}

TEST(HeightExr, chooses_the_channel_that_is_meant) {
    const Folder folder;
    const auto samples = [&](const std::map<std::string, ExrChannel>& channels) {
        write_exr(folder / "u.exr", channels);
        return read_height_image(folder / "u.exr").samples;
    };
    const ExrChannel good{Imf::FLOAT, ramp}, bad{Imf::FLOAT, other};
    EXPECT_EQ(samples({{"anything", good}}), expected_ramp());
    EXPECT_EQ(samples({{"layer.Z", good}}), expected_ramp());
    EXPECT_EQ(samples({{"Y", good}, {"R", bad}, {"A", bad}}), expected_ramp());
    EXPECT_EQ(samples({{"R", good}, {"G", good}, {"B", good}, {"A", bad}}), expected_ramp());
    EXPECT_EQ(samples({{"R", good}, {"A", bad}}), expected_ramp());
    EXPECT_EQ(samples({{"Y", good}, {"RY", {Imf::FLOAT, other, 2}}, {"BY", {Imf::FLOAT, other, 2}}}), expected_ramp());
    const auto why = [&](const std::map<std::string, ExrChannel>& channels) {
        return message_of<UsageError>([&] { samples(channels); });
    };
    EXPECT_NE(why({{"a", good}, {"b.c", good}}).find("none of its channels (a, b.c) is"), std::string::npos);
    EXPECT_NE(why({{"G", good}, {"B", good}}).find("(B, G)"), std::string::npos);
    EXPECT_NE(why({{"R", good}, {"G", good}, {"B", bad}}).find("row 0, column 1 is coloured"), std::string::npos);
    EXPECT_NE(why({{"Y", {Imf::FLOAT, ramp, 2}}}).find("channel Y is sub-sampled"), std::string::npos);
}

TEST(HeightExr, covers_the_display_window) {
    const Folder folder;
    for (const bool tiled : {false, true}) {
        ExrKind kind{.display = {{-2, 10}, {3, 14}}, .data = {{0, 8}, {9, 12}}, .tiled = tiled};
        write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, ramp}}}, kind);
        const HeightImage image = read_height_image(folder / "u.exr");
        ASSERT_EQ(image.columns, 6u);
        ASSERT_EQ(image.rows, 5u);
        for (int row = 0; row < 5; ++row)
            for (int column = 0; column < 6; ++column) {
                const int x = column - 2, y = row + 10;
                EXPECT_EQ(image.samples[static_cast<std::size_t>(row * 6 + column)],
                          x >= 0 && y <= 12 ? ramp(x, y) : 0.0);
            }
        kind.data = {{-5, 2}, {8, 19}}; // overscan all round
        write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, ramp}}}, kind);
        const HeightImage overscanned = read_height_image(folder / "u.exr");
        ASSERT_EQ(overscanned.samples.size(), 30u);
        for (int i = 0; i < 30; ++i)
            EXPECT_EQ(overscanned.samples[static_cast<std::size_t>(i)], ramp(i % 6 - 2, i / 6 + 10));
        kind.data = {{100, 100}, {101, 101}}; // nothing of it is seen
        write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, ramp}}}, kind);
        EXPECT_EQ(read_height_image(folder / "u.exr").samples, std::vector<double>(30, 0.0));
    }
}

TEST(HeightExr, may_be_a_single_sample) {
    const Folder folder;
    write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, [](int, int) { return -0.25; }}}},
              {.display = {{5, 5}, {5, 5}}, .data = {{5, 5}, {5, 5}}});
    EXPECT_EQ(read_height_image(folder / "u.exr").samples, std::vector{-0.25});
}

TEST(HeightExr, must_be_finite) {
    const Folder folder;
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
        const ExrChannel channel{Imf::HALF, [bad](int x, int y) { return x == 3 && y == 1 ? bad : 1.0; }};
        write_exr(folder / "u.exr", {{"Y", channel}});
        const std::string message = message_of<UsageError>([&] { read_height_image(folder / "u.exr"); });
        EXPECT_NE(message.find("u.exr: the pixel in row 1, column 3 is "), std::string::npos) << message;
        EXPECT_NE(message.find(std::isnan(bad) ? "nan" : "-inf"), std::string::npos) << message;
    }
}

TEST(HeightExr, that_announces_too_much_is_refused_before_it_is_read) {
    const Folder folder;
    const ExrChannel channel{Imf::FLOAT, ramp};
    write_exr(folder / "u.exr", {{"Y", channel}}, {.display = {{0, 0}, {1 << 20, 1 << 10}}});
    EXPECT_NE(message_of<UsageError>([&] { read_height_image(folder / "u.exr"); }).find("cannot be used"),
              std::string::npos);
}

} // namespace
} // namespace forceshade
