#include "host/output/height_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <span>
#include <string>
#include <vector>

#include <fmt/core.h>
#include <half.h>

#include "host/error.h"
#include "host/output/exr_image.h"

namespace forceshade {

namespace {

constexpr double kFullScale = 4294967295.0; // of an integer pixel

/// The channels to read: one, or three that must be equal.
std::vector<std::size_t> choose_channels(const ReadableFile& file, const exr::Layer& layer) {
    const auto y = layer.find("Y"), red = layer.find("R"), green = layer.find("G"), blue = layer.find("B");
    std::vector<std::size_t> chosen;
    if (y)
        chosen = {*y};
    else if (layer.channels.size() == 1)
        chosen = {0};
    else if (red && green && blue)
        chosen = {*red, *green, *blue};
    else if (red && !green && !blue)
        chosen = {*red};
    else {
        std::string all;
        for (const exr::Channel& channel : layer.channels)
            all += (all.empty() ? "" : ", ") + channel.name;
        throw UsageError(fmt::format(
            "{}: none of its channels ({}) is a height map's: it needs Y, a single channel, or R, G and B alike",
            file.path().string(), all));
    }
    for (const std::size_t c : chosen)
        if (const exr::Channel& channel = layer.channels[c]; channel.x_sampling != 1 || channel.y_sampling != 1)
            throw UsageError(fmt::format("{}: channel {} is sub-sampled: a height map needs every pixel",
                                         file.path().string(), channel.name));
    return chosen;
}

/// Floats as they are, integers as fractions of full scale.
double value_of(exr_pixel_type_t type, std::span<const std::byte> values, std::size_t index) {
    if (type == EXR_PIXEL_HALF) {
        std::uint16_t bits = 0;
        std::memcpy(&bits, values.data() + index * sizeof bits, sizeof bits);
        return static_cast<double>(static_cast<float>(Imath::half(Imath::half::FromBits, bits)));
    }
    std::uint32_t bits = 0;
    std::memcpy(&bits, values.data() + index * sizeof bits, sizeof bits);
    return type == EXR_PIXEL_UINT ? bits / kFullScale : static_cast<double>(std::bit_cast<float>(bits));
}

/// The value of a pixel, if it can be a height.
double height_at(const ReadableFile& file, const exr::Layer& layer, const std::vector<std::size_t>& chosen,
                 const exr::Line& line, std::size_t index, std::size_t row, std::size_t column) {
    const auto value = [&](std::size_t c) { return value_of(layer.channels[c].type, line.values[c], index); };
    const double first = value(chosen.front());
    for (const std::size_t c : chosen) {
        if (!std::isfinite(value(c)))
            throw UsageError(fmt::format("{}: the pixel in row {}, column {} is {}: a height must be finite",
                                         file.path().string(), row, column, value(c)));
        if (value(c) != first)
            throw UsageError(fmt::format(
                "{}: the pixel in row {}, column {} is coloured: a height map must be grey (R, G and B alike)",
                file.path().string(), row, column));
    }
    return first;
}

} // namespace

HeightImage read_height_exr(const ReadableFile& file) {
    exr::Image source(file, file.path());
    const exr::Layer& layer = source.layers().front();
    if (!layer.is_supported())
        throw UsageError(fmt::format("{}: {}", file.path().string(), exr::kUnsupported));
    HeightImage image;
    image.columns = exr::Layer::extent(layer.display.min.x, layer.display.max.x);
    image.rows = exr::Layer::extent(layer.display.min.y, layer.display.max.y);
    require_height_size(file, image.columns, image.rows);
    require_height_size(file, layer.columns(), layer.rows());
    const std::vector<std::size_t> chosen = choose_channels(file, layer);
    image.samples.assign(image.columns * image.rows, 0.0);
    const auto add_line = [&](const exr::Line& line) {
        const exr::Channel& channel = layer.channels[chosen.front()];
        const std::size_t row = exr::Layer::extent(layer.display.min.y, line.y) - 1;
        const std::size_t width = line.values[chosen.front()].size() / channel.bytes(); // not sub-sampled
        for (std::size_t i = 0; i < width; ++i) {
            const std::int64_t x = line.x + static_cast<std::int64_t>(i);
            if (x < layer.display.min.x || x > layer.display.max.x)
                continue;
            const auto column = static_cast<std::size_t>(x - layer.display.min.x);
            image.samples[row * image.columns + column] = height_at(file, layer, chosen, line, i, row, column);
        }
    };
    const std::int32_t first = std::max(layer.display.min.y, layer.data.min.y);
    const std::int32_t last = std::min(layer.display.max.y, layer.data.max.y);
    if (first <= last)
        source.read(0, first, last, 1, add_line);
    return image;
}

} // namespace forceshade
