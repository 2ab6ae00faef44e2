#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <vector>

#include <ImfChannelList.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfInputFile.h>
#include <fmt/core.h>

#include "host/error.h"
#include "host/io/exr_scan.h"
#include "host/io/exr_stream.h"
#include "host/io/height_formats.h"

namespace forceshade {
namespace {

constexpr double kFullScale = 4294967295.0; // of an integer pixel

/// The channels to read: one, or three that must be alike.
std::vector<std::string> choose_channels(const ReadableFile& file, const Imf::ChannelList& list) {
    std::vector<std::string> names;
    std::string all;
    for (auto channel = list.begin(); channel != list.end(); ++channel) {
        names.emplace_back(channel.name());
        all += all.empty() ? "" : ", ";
        all += channel.name();
    }
    std::vector<std::string> chosen;
    if (list.findChannel("Y"))
        chosen = {"Y"};
    else if (names.size() == 1)
        chosen = names;
    else if (list.findChannel("R") && list.findChannel("G") && list.findChannel("B"))
        chosen = {"R", "G", "B"};
    else if (list.findChannel("R") && !list.findChannel("G") && !list.findChannel("B"))
        chosen = {"R"};
    else
        throw UsageError(
            fmt::format("{}: none of its channels ({}) is a height map's: it needs Y, a single channel, or "
                        "R, G and B alike",
                        file.path().string(), all));
    for (const std::string& name : chosen)
        if (const Imf::Channel& channel = list[name.c_str()]; channel.xSampling != 1 || channel.ySampling != 1)
            throw UsageError(fmt::format("{}: channel {} is sub-sampled: a height map needs every pixel",
                                         file.path().string(), name));
    return chosen;
}

/// One row of the data window, each chosen channel as float or, where the file has integers, as integers.
class RowReader {
public:
    RowReader(Imf::InputFile& input, const std::vector<std::string>& channels) : input_(input), names_(channels) {
        window_ = input.header().dataWindow();
        width_ = static_cast<std::size_t>(std::int64_t{window_.max.x} - window_.min.x + 1);
        for (const std::string& name : names_) {
            integer_.push_back(input.header().channels()[name.c_str()].type == Imf::UINT);
            rows_.emplace_back(width_);
        }
    }

    void read(int y) {
        Imf::FrameBuffer frame;
        for (std::size_t c = 0; c < names_.size(); ++c)
            frame.insert(names_[c],
                         Imf::Slice::Make(integer_[c] ? Imf::UINT : Imf::FLOAT, rows_[c].data(),
                                          Imath::V2i(window_.min.x, y), static_cast<std::int64_t>(width_), 1));
        input_.setFrameBuffer(frame);
        input_.readPixels(y);
    }

    std::size_t channels() const { return names_.size(); }
    double value(std::size_t channel, int x) const {
        const std::uint32_t bits = rows_[channel][static_cast<std::size_t>(std::int64_t{x} - window_.min.x)];
        return integer_[channel] ? bits / kFullScale : static_cast<double>(std::bit_cast<float>(bits));
    }

private:
    Imf::InputFile& input_;
    std::vector<std::string> names_;
    std::vector<bool> integer_;
    std::vector<std::vector<std::uint32_t>> rows_;
    Imath::Box2i window_;
    std::size_t width_ = 0;
};

/// The value of a pixel, if it can be a height.
double require_height(const ReadableFile& file, const RowReader& rows, int x, std::size_t row, std::size_t column) {
    const double value = rows.value(0, x);
    for (std::size_t c = 0; c < rows.channels(); ++c) {
        if (!std::isfinite(rows.value(c, x)))
            throw UsageError(fmt::format("{}: the pixel in row {}, column {} is {}: a height must be finite",
                                         file.path().string(), row, column, rows.value(c, x)));
        if (rows.value(c, x) != value)
            throw UsageError(
                fmt::format("{}: the pixel in row {}, column {} is coloured: a height map must be grey (R, G "
                            "and B alike)",
                            file.path().string(), row, column));
    }
    return value;
}

std::uint64_t extent(int first, int last) {
    return static_cast<std::uint64_t>(std::int64_t{last} - first + 1);
}

HeightImage decode(const ReadableFile& file, Imf::InputFile& input) {
    const Imath::Box2i display = input.header().displayWindow(), data = input.header().dataWindow();
    HeightImage image;
    image.columns = extent(display.min.x, display.max.x);
    image.rows = extent(display.min.y, display.max.y);
    require_height_size(file, image.columns, image.rows);
    require_height_size(file, extent(data.min.x, data.max.x), extent(data.min.y, data.max.y));
    RowReader rows(input, choose_channels(file, input.header().channels()));
    image.samples.assign(image.columns * image.rows, 0.0);
    const int first = std::max(display.min.x, data.min.x), last = std::min(display.max.x, data.max.x);
    for (int y = std::max(display.min.y, data.min.y); y <= std::min(display.max.y, data.max.y); ++y) {
        rows.read(y);
        const std::size_t row = extent(display.min.y, y) - 1;
        for (int x = first; x <= last; ++x) {
            const std::size_t column = extent(display.min.x, x) - 1;
            image.samples[row * image.columns + column] = require_height(file, rows, x, row, column);
        }
    }
    return image;
}

} // namespace

HeightImage read_height_exr(const ReadableFile& file) {
    exr::require_plausible(file, file.path());
    exr::ReadStream stream(file, file.path());
    return exr::guarded(stream, "read", file.path(), [&] {
        Imf::InputFile input(stream, 0);
        return decode(file, input);
    });
}

} // namespace forceshade
