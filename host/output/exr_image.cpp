#include "host/output/exr_image.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include <fmt/core.h>
#include <half.h>

#include "host/error.h"
#include "host/output/height_image.h"

namespace forceshade::exr {

namespace {

constexpr std::uint64_t kMostBlockBytes = 1ull << 30;
constexpr std::uint64_t kBlockOverhead = 16; // bytes: its offset in the table, its first line and its size
/// A byte of the file expands to at most this many: deflate makes 1032 of one, and PXR24 leaves out a quarter before.
constexpr std::uint64_t kMostExpansion = 1400;

} // namespace

std::optional<std::size_t> Layer::find(const std::string& channel) const {
    const auto found = std::ranges::find(channels, channel, &Channel::name);
    return found == channels.end() ? std::nullopt : std::optional<std::size_t>(found - channels.begin());
}

// The input of OpenEXRCore, and the first error that it or the file reported.
struct Image::Context {
    explicit Context(const ReadableFile& from) : file(from) {}
    ~Context() {
        if (handle)
            exr_finish(&handle);
    }
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    static std::int64_t size(exr_const_context_t, void* self) {
        return static_cast<std::int64_t>(static_cast<Context*>(self)->file.size());
    }
    // No exception may cross the library's frames.
    static std::int64_t read(exr_const_context_t, void* self, void* bytes, std::uint64_t count, std::uint64_t offset,
                             exr_stream_error_func_ptr_t) {
        auto& context = *static_cast<Context*>(self);
        try {
            return static_cast<std::int64_t>(
                context.file.read_some(offset, {static_cast<std::byte*>(bytes), static_cast<std::size_t>(count)}));
        } catch (const IoError& error) {
            context.failure = context.failure ? context.failure : error;
            return -1;
        }
    }
    static void complain(exr_const_context_t handle, exr_result_t, const char* message) {
        void* self = nullptr;
        if (!handle || exr_get_user_data(handle, &self) != EXR_ERR_SUCCESS || !self)
            return;
        auto& context = *static_cast<Context*>(self);
        if (context.error_text.empty())
            context.error_text = message;
    }

    const ReadableFile& file;
    exr_context_t handle = nullptr;
    std::optional<IoError> failure; // of the file itself
    std::string error_text;
};

// The pixels of one block.
class Image::Decoder {
public:
    explicit Decoder(const Image& image) : image_(image) {}
    ~Decoder() { reset(); }
    Decoder(const Decoder&) = delete;
    Decoder& operator=(const Decoder&) = delete;

    /// `column` and `row` of a tile, or the first row of a block of rows.
    void read(int part, std::int32_t column, std::int32_t row);
    void give(std::int32_t first, std::int32_t last, const std::function<void(const Line&)>& take);

private:
    exr_const_context_t handle() const { return image_.context_->handle; }
    void reset() {
        if (begun_)
            exr_decoding_destroy(handle(), &pipeline_);
        pipeline_ = {};
        begun_ = false;
    }
    void require(exr_result_t result) const {
        if (result != EXR_ERR_SUCCESS)
            refuse(image_.context_->error_text);
    }
    [[noreturn]] void refuse(const std::string& why) const {
        const bool tiled = image_.layers_[static_cast<std::size_t>(part_)].tiled;
        const std::string place =
            tiled ? fmt::format("tile ({}, {})", column_, row_) : fmt::format("block at row {}", row_);
        image_.damaged(fmt::format("the {} is damaged: {}", place, why));
    }
    void check_size(const exr_chunk_info_t& block) const;

    const Image& image_;
    exr_decode_pipeline_t pipeline_{};
    int part_ = -1;      // of the pipeline
    bool begun_ = false; // it is to be destroyed
    std::int32_t column_ = 0, row_ = 0;
    bool whole_ = false; // the block is there
    Line line_;
};

// OpenEXRCore itself takes an uncompressed block of any size, and an empty one of any compression.
void Image::Decoder::check_size(const exr_chunk_info_t& block) const {
    const bool plain = image_.layers_[static_cast<std::size_t>(part_)].compression == EXR_COMPRESSION_NONE;
    if (block.packed_size == 0 || block.packed_size > block.unpacked_size ||
        (plain && block.packed_size != block.unpacked_size) || block.unpacked_size / kMostExpansion > block.packed_size)
        refuse(fmt::format("{} bytes cannot hold its pixels, which are {}", block.packed_size, block.unpacked_size));
}

void Image::Decoder::read(int part, std::int32_t column, std::int32_t row) {
    if (whole_ && part == part_ && column == column_ && row == row_)
        return;
    whole_ = false;
    column_ = column;
    row_ = row;
    const bool tiled = image_.layers_[static_cast<std::size_t>(part)].tiled;
    if (part != part_)
        reset();
    part_ = part;
    exr_chunk_info_t block{};
    require(tiled ? exr_read_tile_chunk_info(handle(), part, column, row, 0, 0, &block)
                  : exr_read_scanline_chunk_info(handle(), part, row, &block));
    if (begun_) {
        require(exr_decoding_update(handle(), part, &block, &pipeline_));
    } else {
        require(exr_decoding_initialize(handle(), part, &block, &pipeline_));
        begun_ = true;
        require(exr_decoding_choose_default_routines(handle(), part, &pipeline_));
        pipeline_.unpack_and_convert_fn = nullptr; // give() takes the bytes as they are
    }
    check_size(block);
    require(exr_decoding_run(handle(), part, &pipeline_));
    whole_ = true;
}

void Image::Decoder::give(std::int32_t first, std::int32_t last, const std::function<void(const Line&)>& take) {
    const Layer& layer = image_.layers_[static_cast<std::size_t>(part_)];
    const exr_chunk_info_t& block = pipeline_.chunk;
    std::int32_t tile_width = 0, tile_height = 0;
    if (layer.tiled)
        require(exr_get_tile_sizes(handle(), part_, 0, 0, &tile_width, &tile_height));
    line_.x = layer.data.min.x + (layer.tiled ? column_ * tile_width : 0);
    const std::int64_t top = layer.tiled ? std::int64_t{layer.data.min.y} + row_ * tile_height : row_;
    const void* bytes = pipeline_.unpacked_buffer ? pipeline_.unpacked_buffer : pipeline_.packed_buffer;
    std::span left(static_cast<const std::byte*>(bytes), static_cast<std::size_t>(block.unpacked_size));
    line_.values.resize(layer.channels.size());
    for (std::int64_t y = top; y < top + block.height; ++y) {
        line_.y = static_cast<std::int32_t>(y);
        for (std::size_t c = 0; c < layer.channels.size(); ++c) {
            const Channel& channel = layer.channels[c];
            const bool there = line_.y % channel.y_sampling == 0;
            const std::size_t size =
                there ? static_cast<std::size_t>(pipeline_.channels[c].width) * channel.bytes() : 0;
            if (size > left.size())
                refuse("its pixels are more than it holds");
            line_.values[c] = left.first(size);
            left = left.subspan(size);
        }
        if (line_.y >= first && line_.y <= last)
            take(line_);
    }
}

Image::Image(const ReadableFile& file, std::filesystem::path name)
    : file_(file), name_(std::move(name)), context_(std::make_unique<Context>(file)),
      decoder_(std::make_unique<Decoder>(*this)) {
    exr_context_initializer_t start = EXR_DEFAULT_CONTEXT_INITIALIZER;
    start.error_handler_fn = Context::complain;
    start.user_data = context_.get();
    start.read_fn = Context::read;
    start.size_fn = Context::size;
    start.flags = EXR_CONTEXT_FLAG_DISABLE_CHUNK_RECONSTRUCTION;
    int parts = 0;
    const bool opened = exr_start_read(&context_->handle, name_.c_str(), &start) == EXR_ERR_SUCCESS &&
                        exr_get_count(context_->handle, &parts) == EXR_ERR_SUCCESS;
    if (!opened || parts < 1 || !context_->error_text.empty()) // it goes on after some damage
        damaged("no valid EXR file, " + context_->error_text);
    for (int part = 0; part < parts; ++part) {
        layers_.push_back(layer_of(part));
        check_blocks(part, layers_.back());
    }
}

Image::~Image() = default;

void Image::damaged(const std::string& what) const {
    if (context_->failure)
        throw IoError(*context_->failure);
    throw IoError("cannot read {}: {}", name_.string(), what);
}

Layer Image::layer_of(int part) const {
    const exr_const_context_t handle = context_->handle;
    Layer layer;
    exr_storage_t storage = EXR_STORAGE_SCANLINE;
    const exr_attr_chlist_t* channels = nullptr;
    if (exr_get_storage(handle, part, &storage) || exr_get_compression(handle, part, &layer.compression) ||
        exr_get_data_window(handle, part, &layer.data) || exr_get_display_window(handle, part, &layer.display) ||
        exr_get_channels(handle, part, &channels))
        damaged("no valid EXR file, " + context_->error_text);
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        damaged("it is a deep image, which is not supported: flatten it");
    layer.tiled = storage == EXR_STORAGE_TILED;
    if (const char* name = nullptr; exr_get_name(handle, part, &name) == EXR_ERR_SUCCESS && name)
        layer.name = name;
    for (int c = 0; c < channels->num_channels; ++c) {
        const exr_attr_chlist_entry_t& entry = channels->entries[c];
        if (entry.x_sampling < 1 || entry.y_sampling < 1 || entry.pixel_type >= EXR_PIXEL_LAST_TYPE)
            damaged(fmt::format("no valid EXR file, its channel {} cannot be", entry.name.str));
        layer.channels.push_back({entry.name.str, entry.pixel_type, entry.x_sampling, entry.y_sampling});
    }
    context_->error_text.clear(); // that there is no name
    return layer;
}

// Before anything as large as the header says is allocated.
void Image::check_blocks(int part, const Layer& layer) const {
    std::uint64_t bytes = 0;
    std::int32_t blocks = 0;
    if (exr_get_chunk_unpacked_size(context_->handle, part, &bytes) ||
        exr_get_chunk_count(context_->handle, part, &blocks))
        damaged("no valid EXR file, " + context_->error_text);
    if (layer.data.max.x < layer.data.min.x || layer.data.max.y < layer.data.min.y || layer.channels.empty())
        damaged("no valid EXR file, its data window or its channels are missing or empty");
    if (bytes > kMostBlockBytes)
        damaged("a block of pixels would take more than 1 GiB");
    if (blocks < 1 || static_cast<std::uint64_t>(blocks) > file_.size() / kBlockOverhead)
        damaged("it is too short for the pixels that it announces");
}

std::optional<std::string> Image::text(const char* name) const {
    std::int32_t length = 0;
    const char* bytes = nullptr;
    const bool there = exr_attr_get_string(context_->handle, 0, name, &length, &bytes) == EXR_ERR_SUCCESS;
    context_->error_text.clear();
    if (!there || length < 0 || !bytes)
        return std::nullopt;
    return std::string(bytes, static_cast<std::size_t>(length));
}

template <typename Value, typename Get> std::optional<Value> Image::attribute(const char* name, const Get& get) const {
    Value value{};
    const bool there = get(context_->handle, 0, name, &value) == EXR_ERR_SUCCESS;
    context_->error_text.clear();
    return there ? std::optional(value) : std::nullopt;
}

std::optional<exr_attr_v3d_t> Image::vector(const char* name) const {
    return attribute<exr_attr_v3d_t>(name, exr_attr_get_v3d);
}

std::optional<exr_attr_v3i_t> Image::integers(const char* name) const {
    return attribute<exr_attr_v3i_t>(name, exr_attr_get_v3i);
}

void Image::read(std::size_t which, std::int32_t first, std::int32_t last,
                 const std::function<void(const Line&)>& take) {
    const Layer& layer = layers_[which];
    if (!layer.is_supported())
        damaged(kUnsupported);
    const int part = static_cast<int>(which);
    std::int32_t width = 1, height = 1; // of a block; of one of rows the width does not matter
    if (layer.tiled ? exr_get_tile_sizes(context_->handle, part, 0, 0, &width, &height)
                    : exr_get_scanlines_per_chunk(context_->handle, part, &height))
        damaged("no valid EXR file, " + context_->error_text);
    const auto block_row = [&](std::int32_t y) { return (std::int64_t{y} - layer.data.min.y) / height; };
    const std::int64_t columns = layer.tiled ? static_cast<std::int64_t>((layer.columns() - 1) / width + 1) : 1;
    for (std::int64_t block = block_row(first) * columns; block < (block_row(last) + 1) * columns; ++block) {
        const auto row = static_cast<std::int32_t>(block / columns);
        decoder_->read(part, static_cast<std::int32_t>(block % columns),
                       layer.tiled ? row : layer.data.min.y + row * height);
        decoder_->give(first, last, take);
    }
}

} // namespace forceshade::exr

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
        throw UsageError(
            "{}: none of its channels ({}) is a height map's: it needs Y, a single channel, or R, G and B alike",
            file.path().string(), all);
    }
    for (const std::size_t c : chosen)
        if (const exr::Channel& channel = layer.channels[c]; channel.x_sampling != 1 || channel.y_sampling != 1)
            throw UsageError("{}: channel {} is sub-sampled: a height map needs every pixel", file.path().string(),
                             channel.name);
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
            throw UsageError("{}: the pixel in row {}, column {} is {}: a height must be finite", file.path().string(),
                             row, column, value(c));
        if (value(c) != first)
            throw UsageError(
                "{}: the pixel in row {}, column {} is coloured: a height map must be grey (R, G and B alike)",
                file.path().string(), row, column);
    }
    return first;
}

} // namespace

HeightImage read_height_exr(const ReadableFile& file) {
    exr::Image source(file, file.path());
    const exr::Layer& layer = source.layers().front();
    if (!layer.is_supported())
        throw UsageError("{}: {}", file.path().string(), exr::kUnsupported);
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
        source.read(0, first, last, add_line);
    return image;
}

} // namespace forceshade
