#include <gtest/gtest.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/height_image.h"
#include "host/output/reading.h"
#include "tests/io/folder.h"
#include "tests/io/picture.h"

namespace forceshade {
namespace {

using testing::Folder;
using testing::message_of;
using testing::write_png;

using Rows = std::vector<std::vector<png_byte>>;

TEST(HeightPng, of_8_bits_is_fractions_of_255) {
    const Folder folder;
    for (const bool interlaced : {false, true}) {
        write_png(folder / "u.png", 3, Rows{{0, 51, 255}, {1, 2, 254}}, {8, PNG_COLOR_TYPE_GRAY, interlaced, 0.45455});
        const HeightImage image = read_height_image(folder / "u.png");
        EXPECT_EQ(image.columns, 3u);
        EXPECT_EQ(image.rows, 2u);
        EXPECT_EQ(image.samples, (std::vector{0.0, 0.2, 1.0, 1 / 255.0, 2 / 255.0, 254 / 255.0}));
        EXPECT_EQ(image.sha256, sha256_of(read_file(folder / "u.png")));
    }
}

TEST(HeightPng, of_16_bits_keeps_all_of_them) {
    const Folder folder;
    Rows rows(40, std::vector<png_byte>(2 * 30));
    for (std::size_t y = 0; y < 40; ++y)
        for (std::size_t x = 0; x < 30; ++x)
            rows[y][2 * x] = static_cast<png_byte>(6 * y), rows[y][2 * x + 1] = static_cast<png_byte>(7 * x);
    for (const bool interlaced : {false, true}) {
        write_png(folder / "u.png", 30, rows, {16, PNG_COLOR_TYPE_GRAY, interlaced, 1.0});
        const HeightImage image = read_height_image(folder / "u.png");
        for (std::size_t y = 0; y < 40; ++y)
            for (std::size_t x = 0; x < 30; ++x)
                ASSERT_EQ(image.samples[y * 30 + x], static_cast<double>(6 * y * 256 + 7 * x) / 65535.0);
    }
}

TEST(HeightPng, of_fewer_bits_spans_the_full_scale_too) {
    const Folder folder;
    write_png(folder / "u.png", 4, Rows{{0b00011011}}, {2, PNG_COLOR_TYPE_GRAY});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{0.0, 1 / 3.0, 2 / 3.0, 1.0}));
    write_png(folder / "u.png", 2, Rows{{0b10100000}}, {1, PNG_COLOR_TYPE_GRAY});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{1.0, 0.0}));
    write_png(folder / "u.png", 2, Rows{{0x3f}}, {4, PNG_COLOR_TYPE_GRAY, true});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{0.2, 1.0}));
    write_png(folder / "u.png", 1, Rows{{7}}, {8, PNG_COLOR_TYPE_GRAY});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{7 / 255.0}));
}

TEST(HeightPng, may_have_colours_that_are_grey_and_an_alpha_that_is_ignored) {
    const Folder folder;
    write_png(folder / "u.png", 2, Rows{{9, 9, 9, 51, 51, 51}}, {8, PNG_COLOR_TYPE_RGB});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{9 / 255.0, 0.2}));
    write_png(folder / "u.png", 2, Rows{{9, 9, 9, 0, 51, 51, 51, 255}}, {8, PNG_COLOR_TYPE_RGB_ALPHA});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{9 / 255.0, 0.2}));
    write_png(folder / "u.png", 2, Rows{{1, 2, 3, 4, 5, 6, 7, 8}}, {16, PNG_COLOR_TYPE_GRAY_ALPHA});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{258 / 65535.0, 1286 / 65535.0}));
    write_png(folder / "u.png", 2, Rows{{1, 0}}, {8, PNG_COLOR_TYPE_PALETTE}, {{51, 51, 51}, {9, 9, 9}});
    EXPECT_EQ(read_height_image(folder / "u.png").samples, (std::vector{9 / 255.0, 0.2}));
}

TEST(HeightPng, must_not_be_coloured) {
    const Folder folder;
    write_png(folder / "u.png", 2, Rows{{9, 9, 9, 51, 51, 51}, {1, 1, 1, 51, 52, 51}}, {8, PNG_COLOR_TYPE_RGB});
    const auto read = [&] { read_height_image(folder / "u.png"); };
    EXPECT_NE(message_of<UsageError>(read).find("u.png: the pixel in row 1, column 1 is coloured"), std::string::npos);
    write_png(folder / "u.png", 2, Rows{{0, 1}}, {8, PNG_COLOR_TYPE_PALETTE}, {{51, 51, 51}, {9, 9, 8}});
    EXPECT_NE(message_of<UsageError>(read).find("row 0, column 1 is coloured"), std::string::npos);
}

TEST(HeightPng, is_told_by_its_contents) {
    const Folder folder;
    write_png(folder / "u.exr", 1, Rows{{255}});
    EXPECT_EQ(read_height_image(folder / "u.exr").samples, std::vector{1.0});
    write_file_atomically(folder / "u.png", std::string_view("P5 1 1 255\n"));
    const auto read = [&] { read_height_image(folder / "u.png"); };
    EXPECT_NE(message_of<UsageError>(read).find("u.png: neither a PNG nor an OpenEXR image"), std::string::npos);
    write_file_atomically(folder / "u.png", std::string_view(""));
    EXPECT_NE(message_of<IoError>(read).find("it is empty"), std::string::npos);
    EXPECT_THROW(read_height_image(folder / "missing.png"), IoError);
    EXPECT_THROW(read_height_image(folder.path()), IoError);
}

TEST(HeightPng, that_was_cut_off_is_noticed) {
    const Folder folder;
    for (const bool interlaced : {false, true}) {
        write_png(folder / "u.png", 30, Rows(40, std::vector<png_byte>(30, 9)), {8, PNG_COLOR_TYPE_GRAY, interlaced});
        const std::string bytes = read_file(folder / "u.png");
        for (std::size_t size = 8; size < bytes.size(); ++size) {
            write_file_atomically(folder / "cut.png", std::string_view(bytes).substr(0, size));
            EXPECT_THROW(read_height_image(folder / "cut.png"), IoError) << size;
        }
    }
}

TEST(HeightPng, that_announces_too_much_is_refused_before_it_is_read) {
    const Folder folder;
    const auto announce = [&](std::uint32_t width, std::uint32_t height) {
        std::string header = "IHDR";
        for (const std::uint32_t value : {width, height})
            for (int shift = 24; shift >= 0; shift -= 8)
                header += static_cast<char>(value >> shift);
        header += std::string("\x08\x00\x00\x00\x00", 5);
        std::uint32_t crc = 0xffffffffu;
        for (const char c : header) {
            crc ^= static_cast<unsigned char>(c);
            for (int bit = 0; bit < 8; ++bit)
                crc = crc & 1 ? crc >> 1 ^ 0xedb88320u : crc >> 1;
        }
        crc = ~crc;
        std::string bytes("\x89PNG\r\n\x1a\n\0\0\0\x0d", 12);
        bytes += header;
        for (int shift = 24; shift >= 0; shift -= 8)
            bytes += static_cast<char>(crc >> shift);
        bytes += std::string("\0\0\0\0IDAT\x35\xaf\x06\x1e", 12);
        write_file_atomically(folder / "u.png", bytes);
    };
    const auto read = [&] { read_height_image(folder / "u.png"); };
    announce(1u << 20, 1u << 10);
    EXPECT_NE(message_of<UsageError>(read).find("1048576 x 1024 samples cannot be used"), std::string::npos);
    announce(16384, 16384);
    EXPECT_NE(message_of<UsageError>(read).find("a height map of 16384 x 16384 samples needs about 8.0 GiB of memory, "
                                                "more than the 4.0 GiB that are allowed"),
              std::string::npos);
    set_memory_limit(parse_memory("8 GiB"));
    EXPECT_NE(message_of<IoError>(read).find("it is too short for 16384 x 16384 samples"), std::string::npos);
    set_memory_limit(kDefaultMemory);
    announce(0x7fffffffu, 0x7fffffffu);
    EXPECT_THROW(read(), Error);
    announce(1u << 14, 1u << 13); // allowed, but not in a file this short
    EXPECT_NE(message_of<IoError>(read).find("too short for 16384 x 8192 samples"), std::string::npos);
    announce(0, 5);
    EXPECT_THROW(read(), Error);
}

} // namespace
} // namespace forceshade
