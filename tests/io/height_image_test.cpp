// Height maps from EXR and PNG files.
#include <cmath>
#include <cstring>
#include <limits>

#include <fmt/core.h>
#include <gtest/gtest.h>
#include <zlib.h>

#include "host/error.h"
#include "host/output/files.h"
#include "host/output/height_image.h"
#include "tests/io/folder.h"
#include "tests/io/picture.h"

namespace forceshade {
namespace {

using testing::ExrChannel;
using testing::ExrKind;
using testing::Folder;
using testing::message_of;
using testing::says;
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

TEST(HeightExr, TakesFloatsAndHalvesAsTheyAre) {
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

TEST(HeightExr, TakesIntegersAsFractionsOfFullScale) {
    const Folder folder;
    write_exr(folder / "u.exr", {{"height", {Imf::UINT, [](int x, int) { return x == 1 ? 4294967295.0 : x; }}}});
    EXPECT_EQ(read_height_image(folder / "u.exr").samples[1], 1.0);
    EXPECT_EQ(read_height_image(folder / "u.exr").samples[2], 2.0 / 4294967295.0);
}

TEST(HeightExr, ChoosesTheChannelThatIsMeant) {
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
    EXPECT_TRUE(says(why({{"a", good}, {"b.c", good}}), "none of its channels (a, b.c) is"));
    EXPECT_TRUE(says(why({{"G", good}, {"B", good}}), "(B, G)"));
    EXPECT_TRUE(says(why({{"R", good}, {"G", good}, {"B", bad}}), "row 0, column 1 is coloured"));
    EXPECT_TRUE(says(why({{"Y", {Imf::FLOAT, ramp, 2}}}), "channel Y is sub-sampled"));
}

TEST(HeightExr, CoversTheDisplayWindow) {
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

TEST(HeightExr, MayBeASingleSample) {
    const Folder folder;
    write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, [](int, int) { return -0.25; }}}},
              {.display = {{5, 5}, {5, 5}}, .data = {{5, 5}, {5, 5}}});
    EXPECT_EQ(read_height_image(folder / "u.exr").samples, std::vector{-0.25});
}

TEST(HeightExr, MustBeFinite) {
    const Folder folder;
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), -std::numeric_limits<double>::infinity()}) {
        const ExrChannel channel{Imf::HALF, [bad](int x, int y) { return x == 3 && y == 1 ? bad : 1.0; }};
        write_exr(folder / "u.exr", {{"Y", channel}});
        EXPECT_TRUE(says(message_of<UsageError>([&] { read_height_image(folder / "u.exr"); }),
                         "u.exr: the pixel in row 1, column 3 is ", std::isnan(bad) ? "nan" : "-inf"));
    }
}

TEST(HeightExr, ThatAnnouncesTooMuchIsRefusedBeforeItIsRead) {
    const Folder folder;
    const ExrChannel channel{Imf::FLOAT, ramp};
    write_exr(folder / "u.exr", {{"Y", channel}}, {.display = {{0, 0}, {1 << 20, 1 << 10}}});
    EXPECT_TRUE(says(message_of<UsageError>([&] { read_height_image(folder / "u.exr"); }), "cannot be used"));
    write_exr(folder / "u.exr", {{"Y", channel}}, {.display = {{0, 0}, {16383, 16383}}, .data = {{0, 0}, {0, 0}}});
    EXPECT_TRUE(says(message_of<UsageError>([&] { read_height_image(folder / "u.exr"); }), "needs about 8.0 GiB"));
}

// By their numbers in the file.
enum class Packing : char { none = 0, rle = 1, zips = 2, zip = 3, pxr24 = 5 };

std::string deflated(const std::string& bytes) {
    uLongf size = compressBound(bytes.size());
    std::string packed(size, '\0');
    compress(reinterpret_cast<Bytef*>(packed.data()), &size, reinterpret_cast<const Bytef*>(bytes.data()),
             bytes.size());
    return packed.substr(0, size);
}

// What a block of so many bytes of zeros is as packed; of none it is empty.
std::string packed_zeros(Packing packing, std::size_t size) {
    if (size == 0)
        return {};
    std::string differences(size, '\x80'); // of each byte from the one before, plus 128
    differences[0] = 0;
    switch (packing) {
    case Packing::none:
        return std::string(size, '\0');
    case Packing::pxr24:
        return deflated(std::string(size, '\0'));
    case Packing::zips:
    case Packing::zip:
        return deflated(differences);
    case Packing::rle:
        break;
    }
    std::string runs;
    for (std::size_t at = 0; at < size;) {
        std::size_t end = at + 1;
        while (end < size && end - at < 128 && differences[end] == differences[at])
            ++end;
        runs += {static_cast<char>(end - at - 1), differences[at]};
        at = end;
    }
    return runs;
}

// The file, of one part and one block, with other contents of that block.
std::string with_block(const std::string& file, const std::string& contents, bool tiled = false) {
    const auto word = [&](std::size_t at) {
        std::uint64_t value = 0;
        std::memcpy(&value, file.data() + at, sizeof value);
        return value;
    };
    for (std::size_t block = 8; block + 8 <= file.size(); ++block) // behind the table, which has its place
        if (word(block - 8) == block) {
            const auto size = static_cast<std::uint32_t>(contents.size());
            std::string changed = file.substr(0, block + (tiled ? 16 : 4)); // its place in the image, then its size
            changed.append(reinterpret_cast<const char*>(&size), sizeof size);
            return changed + contents;
        }
    throw std::runtime_error("the file has no table of one block");
}

// Less than a block should hold would be read from what the memory held before: run with MALLOC_PERTURB_ to see it.
TEST(HeightExr, WithABlockThatIsTooShortIsDamaged) {
    const Folder folder;
    const auto path = folder / "u.exr";
    for (const Packing packing : {Packing::none, Packing::rle, Packing::zips, Packing::zip, Packing::pxr24})
        for (const Imf::PixelType type : {Imf::FLOAT, Imf::HALF, Imf::UINT})
            for (const bool tiled : {false, true}) {
                SCOPED_TRACE(fmt::format("compression {}, type {}, tiled {}", static_cast<int>(packing),
                                         static_cast<int>(type), tiled));
                const Imath::Box2i window{{0, 0}, tiled ? Imath::V2i(1, 1) : Imath::V2i(63, 0)}; // of one block
                write_exr(path, {{"Y", {type, ramp}}}, {window, window, static_cast<Imf::Compression>(packing), tiled});
                const std::size_t pixels = tiled ? 4 : 64;
                const std::size_t whole = pixels * (type == Imf::HALF                                 ? 2
                                                    : packing == Packing::pxr24 && type == Imf::FLOAT ? 3
                                                                                                      : 4);
                const std::string file = read_file(path);
                const auto rewrite = [&](std::size_t size) {
                    write_file_atomically(path, with_block(file, packed_zeros(packing, size), tiled));
                };
                if (!tiled || packing == Packing::none) { // else it is no smaller packed
                    rewrite(whole);
                    EXPECT_EQ(read_height_image(path).samples, std::vector(pixels, 0.0));
                }
                for (const std::size_t size : {whole - 1, whole / 2, std::size_t{1}, std::size_t{0}}) {
                    rewrite(size);
                    const std::string message = message_of<IoError>([&] { read_height_image(path); });
                    EXPECT_TRUE(says(message, tiled ? "the tile (0, 0) is damaged" : "the block at row 0 is damaged"))
                        << size << message;
                }
            }
}

TEST(HeightExr, WithACompressionThatIsNotReadSaysSo) {
    const Folder folder;
    for (const Imf::Compression compression :
         {Imf::B44_COMPRESSION, Imf::B44A_COMPRESSION, Imf::DWAA_COMPRESSION, Imf::DWAB_COMPRESSION}) {
        write_exr(folder / "u.exr", {{"Y", {Imf::FLOAT, ramp}}}, {.compression = compression});
        EXPECT_TRUE(says(message_of<UsageError>([&] { read_height_image(folder / "u.exr"); }), "save it with ZIP"));
    }
}

using testing::write_png;

using Rows = std::vector<std::vector<png_byte>>;

TEST(HeightPng, Of8BitsIsFractionsOf255) {
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

TEST(HeightPng, Of16BitsKeepsAllOfThem) {
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

TEST(HeightPng, OfFewerBitsSpansTheFullScaleToo) {
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

TEST(HeightPng, MayHaveColoursThatAreGreyAndAnAlphaThatIsIgnored) {
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

TEST(HeightPng, MustNotBeColoured) {
    const Folder folder;
    write_png(folder / "u.png", 2, Rows{{9, 9, 9, 51, 51, 51}, {1, 1, 1, 51, 52, 51}}, {8, PNG_COLOR_TYPE_RGB});
    const auto read = [&] { read_height_image(folder / "u.png"); };
    EXPECT_TRUE(says(message_of<UsageError>(read), "u.png: the pixel in row 1, column 1 is coloured"));
    write_png(folder / "u.png", 2, Rows{{0, 1}}, {8, PNG_COLOR_TYPE_PALETTE}, {{51, 51, 51}, {9, 9, 8}});
    EXPECT_TRUE(says(message_of<UsageError>(read), "row 0, column 1 is coloured"));
}

TEST(HeightPng, IsToldByItsContents) {
    const Folder folder;
    write_png(folder / "u.exr", 1, Rows{{255}});
    EXPECT_EQ(read_height_image(folder / "u.exr").samples, std::vector{1.0});
    write_file_atomically(folder / "u.png", std::string_view("P5 1 1 255\n"));
    const auto read = [&] { read_height_image(folder / "u.png"); };
    EXPECT_TRUE(says(message_of<UsageError>(read), "u.png: neither a PNG nor an OpenEXR image"));
    write_file_atomically(folder / "u.png", std::string_view(""));
    EXPECT_TRUE(says(message_of<IoError>(read), "it is empty"));
    EXPECT_THROW(read_height_image(folder / "missing.png"), IoError);
    EXPECT_THROW(read_height_image(folder.path()), IoError);
}

TEST(HeightPng, ThatWasCutOffIsNoticed) {
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

TEST(HeightPng, ThatAnnouncesTooMuchIsRefusedBeforeItIsRead) {
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
    EXPECT_TRUE(says(message_of<UsageError>(read), "1048576 x 1024 samples cannot be used"));
    announce(16384, 16384);
    EXPECT_TRUE(says(message_of<UsageError>(read),
                     "a height map of 16384 x 16384 samples needs about 8.0 GiB of memory, "
                     "more than the 4.0 GiB that are allowed"));
    set_memory_limit(parse_memory("8 GiB"));
    EXPECT_TRUE(says(message_of<IoError>(read), "it is too short for 16384 x 16384 samples"));
    set_memory_limit(kDefaultMemory);
    announce(0x7fffffffu, 0x7fffffffu);
    EXPECT_THROW(read(), Error);
    announce(1u << 14, 1u << 13); // allowed, but not in a file this short
    EXPECT_TRUE(says(message_of<IoError>(read), "too short for 16384 x 8192 samples"));
    announce(0, 5);
    EXPECT_THROW(read(), Error);
}

} // namespace
} // namespace forceshade
