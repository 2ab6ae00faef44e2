// Damaged pictures: only our own errors come out.
#include <random>

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

/// Reads the file `rounds` times with a few bytes changed each time; returns how often that was noticed.
int read_damaged(const std::filesystem::path& path, int rounds, unsigned seed) {
    const std::string sound = read_file(path);
    std::mt19937 random(seed);
    int noticed = 0;
    for (int round = 0; round < rounds; ++round) {
        std::string bytes = sound;
        for (std::uint32_t i = 0; i <= random() % 3; ++i)
            bytes[random() % bytes.size()] = static_cast<char>(random() % 3 ? random() : 0xff);
        if (random() % 8 == 0)
            bytes.resize(random() % bytes.size());
        write_file_atomically(path, bytes);
        try {
            const HeightImage image = read_height_image(path);
            EXPECT_EQ(image.samples.size(), image.columns * image.rows);
        } catch (const Error&) {
            ++noticed;
        }
    }
    return noticed;
}

TEST(DamagedPicture, png_ends_in_our_errors) {
    const Folder folder;
    std::vector<std::vector<png_byte>> rows(9, std::vector<png_byte>(44));
    for (std::size_t i = 0; i < 9 * 44; ++i)
        rows[i / 44][i % 44] = static_cast<png_byte>(i * i);
    unsigned seed = 1;
    for (const int depth : {8, 16})
        for (const bool interlaced : {false, true}) {
            testing::write_png(folder / "u.png", depth == 8 ? 44 : 22, rows, {depth, PNG_COLOR_TYPE_GRAY, interlaced});
            EXPECT_GT(read_damaged(folder / "u.png", 200, ++seed), 150);
        }
}

TEST(DamagedPicture, exr_ends_in_our_errors) {
    const Folder folder;
    const auto value = [](int x, int y) { return std::sin(x + 10.0 * y); };
    unsigned seed = 1;
    for (const Imf::Compression compression : {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION,
                                               Imf::PIZ_COMPRESSION, Imf::PXR24_COMPRESSION})
        for (const bool tiled : {false, true}) {
            testing::write_exr(folder / "u.exr", {{"R", {Imf::HALF, value}}, {"A", {Imf::FLOAT, value}}},
                               {{{0, 0}, {19, 19}}, {{0, 0}, {19, 19}}, compression, tiled});
            EXPECT_GT(read_damaged(folder / "u.exr", 150, ++seed), 20);
        }
}

} // namespace
} // namespace forceshade
