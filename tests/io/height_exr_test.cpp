#include <cmath>
#include <limits>

#include <fmt/core.h>
#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/height_image.h"
#include "host/output/reading.h"
#include "tests/io/folder.h"
#include "tests/io/picture.h"
#include "tests/io/short_block.h"

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
                 {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIPS_COMPRESSION, Imf::ZIP_COMPRESSION,
                  Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION}) {
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
    write_exr(folder / "u.exr", {{"Y", channel}}, {.display = {{0, 0}, {16383, 16383}}, .data = {{0, 0}, {0, 0}}});
    EXPECT_NE(message_of<UsageError>([&] { read_height_image(folder / "u.exr"); }).find("needs about 8.0 GiB"),
              std::string::npos);
}

// Less than a block should hold would be read from what the memory held before: run with MALLOC_PERTURB_ to see it.
TEST(HeightExr, with_a_block_that_is_too_short_is_damaged) {
    const Folder folder;
    const auto path = folder / "u.exr";
    for (const testing::Packing packing : {testing::Packing::none, testing::Packing::rle, testing::Packing::zips,
                                           testing::Packing::zip, testing::Packing::pxr24})
        for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF, Imf::UINT})
            for (const bool tiled : {false, true}) {
                SCOPED_TRACE(fmt::format("compression {}, type {}, tiled {}", static_cast<int>(packing),
                                         static_cast<int>(type), tiled));
                const Imath::Box2i window{{0, 0}, tiled ? Imath::V2i(1, 1) : Imath::V2i(63, 0)}; // of one block
                write_exr(path, {{"Y", {type, ramp}}}, {window, window, static_cast<Imf::Compression>(packing), tiled});
                const std::size_t pixels = tiled ? 4 : 64;
                const std::size_t whole = pixels * (type == Imf::HALF                                          ? 2
                                                    : packing == testing::Packing::pxr24 && type == Imf::FLOAT ? 3
                                                                                                               : 4);
                const std::string file = read_file(path);
                const auto rewrite = [&](std::size_t size) {
                    write_file_atomically(path, testing::with_block(file, testing::packed_zeros(packing, size), tiled));
                };
                if (!tiled || packing == testing::Packing::none) { // else it is no smaller packed
                    rewrite(whole);
                    EXPECT_EQ(read_height_image(path).samples, std::vector(pixels, 0.0));
                }
                for (const std::size_t size : {whole - 1, whole / 2, std::size_t{1}, std::size_t{0}}) {
                    rewrite(size);
                    const std::string message = message_of<IoError>([&] { read_height_image(path); });
                    EXPECT_NE(message.find(tiled ? "the tile (0, 0) is damaged" : "the block at row 0 is damaged"),
                              std::string::npos)
                        << size << message;
                }
            }
}

TEST(HeightExr, with_a_compression_that_is_not_read_says_so) {
    const Folder folder;
    for (const Imf::Compression compression :
         {Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
        write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, ramp}}}, {.compression = compression});
        const std::string message = message_of<UsageError>([&] { read_height_image(folder / "u.exr"); });
        EXPECT_NE(message.find("save it with ZIP"), std::string::npos) << message;
    }
}

} // namespace
} // namespace forceshade
