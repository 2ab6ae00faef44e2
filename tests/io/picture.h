// Pictures for tests, written with the libraries' own means: PNG of any kind, EXR with any channels and windows.
#pragma once

#include <cstdio>
#include <filesystem>
#include <functional>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfOutputFile.h>
#include <ImfTiledOutputFile.h>
#include <png.h>

namespace forceshade::testing {

struct PngKind {
    int depth = 8;
    int colour = PNG_COLOR_TYPE_GRAY;
    bool interlaced = false;
    double gamma = 0; // as a gAMA chunk; 0: none
};

/// `rows` hold the bytes as PNG stores them: packed bits, or two bytes a sample, the high one first.
inline void write_png(const std::filesystem::path& path, png_uint_32 width, std::vector<std::vector<png_byte>> rows,
                      const PngKind& kind = {}, const std::vector<png_color>& palette = {}) {
    std::FILE* file = std::fopen(path.c_str(), "wb");
    png_structp png = png_create_write_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_set_IHDR(png, info, width, static_cast<png_uint_32>(rows.size()), kind.depth, kind.colour,
                 kind.interlaced ? PNG_INTERLACE_ADAM7 : PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT,
                 PNG_FILTER_TYPE_DEFAULT);
    if (!palette.empty())
        png_set_PLTE(png, info, palette.data(), static_cast<int>(palette.size()));
    if (kind.gamma > 0)
        png_set_gAMA(png, info, kind.gamma);
    std::vector<png_bytep> pointers;
    for (auto& row : rows)
        pointers.push_back(row.data());
    png_write_info(png, info);
    png_write_image(png, pointers.data());
    png_write_end(png, info);
    png_destroy_write_struct(&png, &info);
    std::fclose(file);
}

struct ExrChannel {
    Imf::PixelType type = Imf::FLOAT;
    std::function<double(int, int)> value; // of pixel (x, y)
    int sampling = 1;                      // along x: every how many pixels there is one
};

struct ExrKind {
    Imath::Box2i display{{0, 0}, {3, 2}};
    Imath::Box2i data{{0, 0}, {3, 2}};
    Imf::Compression compression = Imf::ZIP_COMPRESSION;
    bool tiled = false;
    Imath::V2i tile{2, 2};
};

inline void write_exr(const std::filesystem::path& path, const std::map<std::string, ExrChannel>& channels,
                      const ExrKind& kind = {}) {
    Imf::Header header(kind.display, kind.data);
    header.compression() = kind.compression;
    const int width = kind.data.max.x - kind.data.min.x + 1, height = kind.data.max.y - kind.data.min.y + 1;
    std::vector<std::vector<std::uint32_t>> storage;
    Imf::FrameBuffer frame;
    for (const auto& [name, channel] : channels) {
        header.channels().insert(name, Imf::Channel(channel.type, channel.sampling, 1));
        std::vector<std::uint32_t>& pixels = storage.emplace_back(static_cast<std::size_t>(width * height));
        for (int y = 0; y < height; ++y)
            for (int x = 0; x < width; x += channel.sampling) {
                const double value = channel.value(x + kind.data.min.x, y + kind.data.min.y);
                void* target = &pixels[static_cast<std::size_t>(y * width + x / channel.sampling)];
                if (channel.type == Imf::UINT)
                    *static_cast<std::uint32_t*>(target) = static_cast<std::uint32_t>(value);
                else if (channel.type == Imf::FLOAT)
                    *static_cast<float*>(target) = static_cast<float>(value);
                else
                    *static_cast<half*>(target) = half(static_cast<float>(value));
            }
        const auto origin =
            reinterpret_cast<std::uintptr_t>(pixels.data()) -
            static_cast<std::uintptr_t>((kind.data.min.y * width + kind.data.min.x / channel.sampling) * 4);
        frame.insert(name, Imf::Slice(channel.type, reinterpret_cast<char*>(origin), 4, // NOLINT
                                      static_cast<std::size_t>(4 * width), channel.sampling, 1));
    }
    if (kind.tiled) {
        header.setTileDescription(Imf::TileDescription(static_cast<unsigned>(kind.tile.x),
                                                       static_cast<unsigned>(kind.tile.y), Imf::ONE_LEVEL));
        Imf::TiledOutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
    } else {
        Imf::OutputFile file(path.c_str(), header);
        file.setFrameBuffer(frame);
        file.writePixels(height);
    }
}

} // namespace forceshade::testing
