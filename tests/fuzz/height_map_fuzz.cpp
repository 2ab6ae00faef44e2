// A height map, PNG or EXR: read or refused; one that the libraries' own writers write is read pixel by pixel.
#include "host/error.h"
#include "host/output/files.h"
#include "host/output/height_image.h"
#include "tests/fuzz/fuzz.h"
#include "tests/io/picture.h"

namespace forceshade {
namespace {

using fuzz::Bytes;
using fuzz::require;

/// Grey, with an alpha channel, or of three colours; then one pixel may have a blue of its own.
void check_png(Bytes& bytes, const std::filesystem::path& path) {
    const std::uint8_t kind = bytes.byte();
    const int colour = kind % 3 == 0   ? PNG_COLOR_TYPE_GRAY
                       : kind % 3 == 1 ? PNG_COLOR_TYPE_GRAY_ALPHA
                                       : PNG_COLOR_TYPE_RGB;
    const int depth = colour == PNG_COLOR_TYPE_GRAY ? 1 << kind / 4 % 5 : kind & 4 ? 16 : 8;
    const unsigned width = 1 + kind / 32, height = 1 + static_cast<unsigned>(bytes.below(6));
    const int components = colour == PNG_COLOR_TYPE_RGB ? 3 : colour == PNG_COLOR_TYPE_GRAY ? 1 : 2;
    const bool tinted = colour == PNG_COLOR_TYPE_RGB && bytes.below(4) == 0;
    std::vector<std::vector<png_byte>> rows(height);
    std::vector<double> expected;
    for (auto& row : rows) {
        unsigned filled = 0;
        for (unsigned x = 0; x < width; ++x) {
            const unsigned level = (bytes.byte() * 256u + bytes.byte()) >> (16 - depth);
            expected.push_back(level / static_cast<double>((1u << depth) - 1));
            for (int c = 0; c < components; ++c) {
                const unsigned value = c == 1 && components == 2 ? 0 : tinted && c == 2 && x == 0 ? level ^ 1u : level;
                for (int bit = depth - 1; bit >= 0; --bit, ++filled) {
                    if (filled % 8 == 0)
                        row.push_back(0);
                    row.back() = static_cast<png_byte>(row.back() | (value >> bit & 1u) << (7 - filled % 8));
                }
            }
        }
    }
    testing::write_png(path, width, rows, {depth, colour, (kind & 1) != 0});
    try {
        const HeightImage image = read_height_image(path);
        require(image.columns == width && image.rows == height && image.samples == expected && !tinted,
                "a PNG picture is read as another");
    } catch (const UsageError&) {
        require(tinted, "a grey PNG is refused");
    }
    std::filesystem::resize_file(path, std::filesystem::file_size(path) - 1 - bytes.below(16)); // its last chunk has 12
    bool read = true;
    try {
        read_height_image(path);
    } catch (const Error&) {
        read = false;
    }
    require(!read, "a PNG without its end is read");
}

void check_exr(Bytes& bytes, const std::filesystem::path& path) {
    const auto window = [&] {
        const int x = static_cast<int>(bytes.below(5)) - 2, y = static_cast<int>(bytes.below(5)) - 2;
        return Imath::Box2i({x, y}, {x + static_cast<int>(bytes.below(4)), y + static_cast<int>(bytes.below(4))});
    };
    const Imath::Box2i display = window(), data = window();
    const Imf::PixelType type = static_cast<Imf::PixelType>(bytes.below(3));
    const Imf::Compression all[] = {Imf::NO_COMPRESSION, Imf::RLE_COMPRESSION, Imf::ZIP_COMPRESSION,
                                    Imf::PIZ_COMPRESSION};
    const Imf::Compression compression = all[bytes.below(4)];
    const bool tiled = bytes.below(2) != 0;
    const int factor = 1 + static_cast<int>(bytes.below(200));
    const auto value = [&](int x, int y) { return std::abs((x + 3) * 7 + (y + 3) * factor); }; // exact as a half, too
    const std::size_t kind = bytes.below(4);
    std::map<std::string, testing::ExrChannel> channels{{"Y", {type, value}}};
    std::optional<Imath::V2i> coloured; // a pixel of one whose channels are not alike
    if (kind > 0) {
        channels = {{"R", {type, value}}, {"G", {type, value}}, {"B", {type, value}}};
        if (kind > 1)
            coloured = data.min;
        channels[kind == 2 ? "G" : "B"].value = [&](int x, int y) {
            return value(x, y) + (coloured == Imath::V2i(x, y) ? 1 : 0);
        };
    }
    const Imath::V2i tile(1 + static_cast<int>(bytes.below(3)), 1 + static_cast<int>(bytes.below(3)));
    testing::write_exr(path, channels, {display, data, compression, tiled, tile});
    HeightImage image;
    try {
        image = read_height_image(path);
        require(!coloured || !display.intersects(*coloured), "a coloured EXR picture is read");
    } catch (const UsageError&) {
        require(coloured && display.intersects(*coloured), "a grey EXR picture is refused");
        return;
    }
    const auto columns = static_cast<std::size_t>(display.max.x - display.min.x + 1);
    require(image.columns == columns &&
                image.samples.size() == columns * static_cast<std::size_t>(display.max.y - display.min.y + 1),
            "an EXR picture has another size");
    std::size_t at = 0;
    for (int y = display.min.y; y <= display.max.y; ++y)
        for (int x = display.min.x; x <= display.max.x; ++x) {
            const double there = data.intersects(Imath::V2i(x, y)) ? value(x, y) : 0;
            const double expected = type == Imf::UINT ? there / 4294967295.0 : there;
            const double found = image.samples[at++];
            require(found == expected, "the pixel ({}, {}) is {}, not {}", x, y, found, expected);
        }
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace forceshade;
    static fuzz::MemoryFile file;
    set_memory_limit(std::uint64_t{16} << 20); // what is announced and not there takes long to fill
    if (size > 0 && data[0] < 2) {
        fuzz::Bytes bytes(data + 1, size - 1);
        data[0] == 0 ? check_png(bytes, file.path()) : check_exr(bytes, file.path());
        return 0;
    }
    file.write({reinterpret_cast<const char*>(data), size});
    try {
        const HeightImage image = read_height_image(file.path());
        fuzz::require(image.columns > 0 && image.rows > 0 && image.samples.size() == image.columns * image.rows,
                      "{} samples of {} x {}", image.samples.size(), image.columns, image.rows);
        for (const double sample : image.samples)
            fuzz::require(std::isfinite(sample), "a sample is {}", sample);
        fuzz::require(read_height_image(file.path()).samples == image.samples, "read again, samples are others");
    } catch (const Error&) {
    }
    return 0;
}
