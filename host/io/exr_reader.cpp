#include <algorithm>
#include <cstring>
#include <span>

#include <fmt/core.h>
#include <half.h>

#include "host/error.h"
#include "host/io/chunk_rows.h"
#include "host/io/exr_image.h"
#include "host/io/exr_parts.h"
#include "host/io/exr_volume.h"
#include "host/io/hash.h"

namespace forceshade {
namespace exr {
namespace {

exr_pixel_type_t type_of(PixelFormat format) {
    if (format == PixelFormat::id)
        return EXR_PIXEL_UINT;
    return format == PixelFormat::half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
}

bool is_alike(const Layer& layer, const Part& part, std::uint64_t width, std::uint64_t rows) {
    if (layer.tiled || layer.data.min.x != 0 || layer.data.min.y != 0 || layer.columns() != width ||
        layer.rows() != rows || layer.channels.size() != part.channels.size())
        return false;
    return std::ranges::all_of(part.channels, [&](const char* name) {
        const auto found = layer.find(name);
        return found && layer.channels[*found].type == type_of(part.format) && layer.channels[*found].x_sampling == 1 &&
               layer.channels[*found].y_sampling == 1;
    });
}

/// Every `stride` bytes of the target one value of the line.
template <typename Value, typename From>
void spread(std::span<const std::byte> values, std::size_t stride, std::byte* target, const From& from) {
    for (std::size_t at = 0; at < values.size(); at += sizeof(Value), target += stride) {
        Value value;
        std::memcpy(&value, values.data() + at, sizeof value);
        const auto converted = from(value);
        std::memcpy(target, &converted, sizeof converted);
    }
}

/// Rows of a part as they stand in memory: samples interleaved by component; halves as they are, or `widened` to
/// floats.
void read_rows(Image& image, std::size_t layer, const Part& part, std::uint64_t first, std::uint64_t count,
               bool widened, int threads, std::byte* target) {
    std::vector<std::size_t> places; // of the components in the file
    for (const char* name : part.channels)
        places.push_back(*image.layers()[layer].find(name));
    const bool half = part.format == PixelFormat::half;
    const std::size_t bytes = half && !widened ? 2 : 4, stride = part.channels.size() * bytes;
    const std::size_t row_bytes = static_cast<std::size_t>(image.layers()[layer].columns()) * stride;
    const auto take = [&](const Line& line) {
        std::byte* row = target + (static_cast<std::uint64_t>(line.y) - first) * row_bytes;
        for (std::size_t c = 0; c < places.size(); ++c, row += bytes) {
            const std::span<const std::byte> values = line.values[places[c]];
            const auto as_it_is = [](auto value) { return value; };
            if (!half)
                spread<std::uint32_t>(values, stride, row, as_it_is);
            else if (!widened)
                spread<std::uint16_t>(values, stride, row, as_it_is);
            else
                spread<std::uint16_t>(values, stride, row, [](std::uint16_t bits) {
                    return static_cast<float>(Imath::half(Imath::half::FromBits, bits));
                });
        }
    };
    image.read(layer, static_cast<std::int32_t>(first), static_cast<std::int32_t>(first + count - 1), threads, take);
}

} // namespace

std::vector<std::uint64_t> checksums_of(const std::filesystem::path& file, const std::filesystem::path& path,
                                        const Sheet& sheet) {
    const ReadableFile source(file);
    Image image(source, path, "read back");
    const std::uint64_t group = rows_per_group(sheet.width, sheet.rows);
    std::vector<std::uint64_t> checksums;
    for (std::size_t i = 0; i < sheet.parts.size(); ++i) {
        const Part& part = sheet.parts[i];
        if (i >= image.layers().size() || !is_alike(image.layers()[i], part, sheet.width, sheet.rows))
            image.damaged(fmt::format("its part {} is laid out in another way than it was written",
                                      name_of_channel(part.channel)));
        const std::size_t row_bytes = sheet.width * part.sample_bytes();
        std::vector<std::byte> rows(std::min(group, sheet.rows) * row_bytes);
        PixelChecksum checksum;
        for (std::uint64_t first = 0; first < sheet.rows; first += group) {
            const std::uint64_t count = std::min(group, sheet.rows - first);
            read_rows(image, i, part, first, count, false, sheet.threads, rows.data());
            checksum.update(std::span(rows).first(count * row_bytes));
        }
        checksums.push_back(checksum.value());
    }
    return checksums;
}

} // namespace exr

struct VolumeReader::State {
    State(const std::filesystem::path& path_, int threads);

    VolumeHeader read_header(int threads) const;
    void require_alike(const exr::Layer& found, const exr::Part& part) const;
    [[noreturn]] void foreign(const std::string& what) const;
    void read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, std::byte* target);

    std::filesystem::path path;
    ReadableFile file;
    exr::Image image;
    VolumeHeader header;
    std::vector<exr::Part> parts;
};

namespace {

std::optional<Compression> compression_from(exr_compression_t compression) {
    switch (compression) {
    case EXR_COMPRESSION_NONE:
        return Compression::none;
    case EXR_COMPRESSION_ZIPS:
        return Compression::zip1;
    case EXR_COMPRESSION_ZIP:
        return Compression::zip;
    case EXR_COMPRESSION_PXR24:
        return Compression::pxr24;
    default:
        return std::nullopt;
    }
}

std::uint32_t channel_named(const std::string& name) {
    for (const std::uint32_t channel : {layout::kChannelForce, layout::kChannelDepth, layout::kChannelFacet,
                                        layout::kChannelProxy, layout::kChannelUnshaded})
        if (name == name_of_channel(channel))
            return channel;
    return 0;
}

} // namespace

void VolumeReader::State::foreign(const std::string& what) const {
    throw IoError(fmt::format("cannot read {}: it is no volume of this program, {}", path.string(), what));
}

VolumeReader::State::State(const std::filesystem::path& path_, int threads)
    : path(path_), file(path_), image(file, path_), header(read_header(threads)), parts(exr::parts_of(header)) {
    for (std::size_t i = 0; i < parts.size(); ++i)
        require_alike(image.layers()[i], parts[i]);
}

VolumeHeader VolumeReader::State::read_header(int threads) const {
    VolumeHeader found;
    const exr::Layer& first = image.layers().front();
    const auto text = [&](const char* name) {
        const auto value = image.text(name);
        if (!value)
            foreign(fmt::format("it lacks {}", name));
        return *value;
    };
    const auto vector = [&](const char* name) {
        const auto value = image.vector(name);
        if (!value)
            foreign(fmt::format("it lacks {}", name));
        return std::array{value->x, value->y, value->z};
    };
    const auto grid = image.integers("forceshade.grid");
    if (!grid || grid->x < 1 || grid->y < 1 || grid->z < 1)
        foreign("it lacks forceshade.grid");
    found.size = {static_cast<std::uint64_t>(grid->x), static_cast<std::uint64_t>(grid->y),
                  static_cast<std::uint64_t>(grid->z)};
    found.origin = vector("forceshade.origin");
    found.spacing = vector("forceshade.spacing");
    found.scene = text("forceshade.scene");
    found.version = text("forceshade.version");
    found.omitted = text("forceshade.omitted");
    found.threads = threads;
    const auto compression = compression_from(first.compression);
    if (!compression)
        foreign("its compression is another");
    found.compression = *compression;
    const auto red = first.find("R");
    found.pixel = red && first.channels[*red].type == EXR_PIXEL_HALF ? PixelType::half : PixelType::float32;
    found.channels = 0;
    for (const exr::Layer& layer : image.layers())
        found.channels |= channel_named(layer.name);
    if (!(found.channels & layout::kChannelForce) || exr::parts_of(found).size() != image.layers().size())
        foreign("its parts are others");
    try {
        exr::require_possible(found);
    } catch (const UsageError& error) {
        foreign(error.what());
    }
    return found;
}

void VolumeReader::State::require_alike(const exr::Layer& found, const exr::Part& part) const {
    if (!exr::is_alike(found, part, header.size[0], header.size[1] * header.size[2]) ||
        compression_from(found.compression) != header.compression || found.name != name_of_channel(part.channel))
        foreign(fmt::format("its part {} is laid out in another way", name_of_channel(part.channel)));
}

void VolumeReader::State::read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, std::byte* target) {
    const auto found = std::ranges::find(parts, channel, &exr::Part::channel);
    exr::read_rows(image, static_cast<std::size_t>(found - parts.begin()), *found, first, count, true, header.threads,
                   target);
}

VolumeReader::VolumeReader(const std::filesystem::path& path, int threads)
    : state_(std::make_unique<State>(path, threads)) {}
VolumeReader::~VolumeReader() = default;

const VolumeHeader& VolumeReader::header() const noexcept {
    return state_->header;
}
std::uint64_t VolumeReader::rows() const noexcept {
    return state_->header.size[1] * state_->header.size[2];
}

void VolumeReader::read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, std::vector<float>& values) {
    const bool there = (state_->header.channels & channel) && channel != layout::kChannelFacet;
    if (!there || count > rows() || first > rows() - count)
        state_->foreign(fmt::format("it lacks {} in rows {} to {}", name_of_channel(channel), first, first + count));
    values.resize(count * state_->header.size[0] * components_of(channel));
    if (count > 0)
        state_->read(channel, first, count, std::as_writable_bytes(std::span(values)).data());
}

void VolumeReader::read_ids(std::uint64_t first, std::uint64_t count, std::vector<std::uint32_t>& ids) {
    if (!(state_->header.channels & layout::kChannelFacet) || count > rows() || first > rows() - count)
        state_->foreign(fmt::format("it lacks facet in rows {} to {}", first, first + count));
    ids.resize(count * state_->header.size[0]);
    if (count > 0)
        state_->read(layout::kChannelFacet, first, count, std::as_writable_bytes(std::span(ids)).data());
}

} // namespace forceshade
