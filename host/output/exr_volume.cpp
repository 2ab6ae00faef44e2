#include "host/output/exr_volume.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <span>

#include <fmt/core.h>
#include <half.h>

#include "host/error.h"
#include "host/output/exr_image.h"
#include "host/output/files.h"
#include "host/output/rows.h"
#include "host/scene/scene.h"

namespace forceshade {
namespace exr {
namespace {

const char* unit_of(std::uint32_t channel) {
    constexpr std::uint32_t kForces = layout::kChannelForce | layout::kChannelUnshaded | kChannelMagnitudeError;
    return channel == layout::kChannelFacet ? "1" : channel == kChannelAngle ? "deg" : channel & kForces ? "N" : "m";
}

std::optional<Compression> compression_from(exr_compression_t compression) {
    const auto found = std::ranges::find(exr::kCompressions, compression);
    return found == exr::kCompressions.end()
               ? std::nullopt
               : std::optional(static_cast<Compression>(found - exr::kCompressions.begin()));
}

} // namespace

Part make_part(std::uint32_t channel, PixelType pixel, Compression compression) {
    std::vector<const char*> names{"R", "G", "B"};
    if (components_of(channel) == 1)
        names = {channel == layout::kChannelFacet ? "id" : channel == layout::kChannelDepth ? "Z" : "Y"};
    const PixelFormat format = channel == layout::kChannelFacet    ? PixelFormat::id
                               : pixel == PixelType::half          ? PixelFormat::half
                               : compression == Compression::pxr24 ? PixelFormat::float24
                                                                   : PixelFormat::float32;
    return {channel, std::move(names), unit_of(channel), format};
}

std::vector<Part> parts_of(const VolumeHeader& header) {
    std::vector<Part> parts;
    for (const std::uint32_t channel : kFieldChannels)
        if (channel == layout::kChannelForce || (header.channels & channel))
            parts.push_back(make_part(channel, header.pixel, header.compression));
    return parts;
}

void require_possible(const VolumeHeader& header) {
    const auto [nx, ny, nz] = header.size;
    if (nx == 0 || ny == 0 || nz == 0)
        throw UsageError("a grid of {} x {} x {} samples is empty: every size must be 1 or more", nx, ny, nz);
    if (ny > kMostRows / nz)
        throw UsageError(
            "a grid of {} x {} x {} samples has more than the {} rows (y times z) that an EXR holds: make it smaller",
            nx, ny, nz, kMostRows);
    if (nx > kMostColumns)
        throw UsageError("a grid of {} samples along x is wider than the {} that an EXR holds: make it smaller", nx,
                         kMostColumns);
}

namespace {

exr_pixel_type_t type_of(PixelFormat format) {
    if (format == PixelFormat::id)
        return EXR_PIXEL_UINT;
    return format == PixelFormat::half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT;
}

bool has_layout(const Layer& layer, const Part& part, std::uint64_t width, std::uint64_t rows) {
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

/// Rows of a part as they stand in memory: samples interleaved by component; halves as floats.
void read_rows(Image& image, std::size_t layer, const Part& part, std::uint64_t first, std::uint64_t count,
               std::byte* target) {
    std::vector<std::size_t> places; // of the components in the file
    for (const char* name : part.channels)
        places.push_back(*image.layers()[layer].find(name));
    const bool half = part.format == PixelFormat::half;
    const std::size_t bytes = 4, stride = part.channels.size() * bytes;
    const std::size_t row_bytes = static_cast<std::size_t>(image.layers()[layer].columns()) * stride;
    const auto take = [&](const Line& line) {
        std::byte* row = target + (static_cast<std::uint64_t>(line.y) - first) * row_bytes;
        for (std::size_t c = 0; c < places.size(); ++c, row += bytes) {
            const std::span<const std::byte> values = line.values[places[c]];
            if (!half)
                spread<std::uint32_t>(values, stride, row, [](std::uint32_t value) { return value; });
            else
                spread<std::uint16_t>(values, stride, row, [](std::uint16_t bits) {
                    return static_cast<float>(Imath::half(Imath::half::FromBits, bits));
                });
        }
    };
    image.read(layer, static_cast<std::int32_t>(first), static_cast<std::int32_t>(first + count - 1), take);
}

glm::dvec3 place_origin_of(const Image& image) {
    const auto origin = image.vector("forceshade.place_origin");
    return origin ? glm::dvec3(origin->x, origin->y, origin->z) : glm::dvec3(0);
}

} // namespace

} // namespace exr

struct VolumeReader::State {
    explicit State(const std::filesystem::path& path_)
        : path(path_), file(path_), image(file, path_), header(read_header()), parts(exr::parts_of(header)) {
        for (std::size_t i = 0; i < parts.size(); ++i)
            require_layout(image.layers()[i], parts[i]);
    }

    VolumeHeader read_header() const;
    void require_layout(const exr::Layer& found, const exr::Part& part) const {
        if (!exr::has_layout(found, part, header.size[0], rows()) ||
            exr::compression_from(found.compression) != header.compression ||
            found.name != name_of_channel(part.channel))
            refuse(fmt::format("its part {} has another layout", name_of_channel(part.channel)));
    }
    [[noreturn]] void refuse(const std::string& why) const {
        throw IoError("cannot read {}: it is not a volume of this program, {}", path.string(), why);
    }

    std::uint64_t rows() const { return header.size[1] * header.size[2]; }
    template <typename Value>
    void read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, std::vector<Value>& values) {
        const auto part = std::ranges::find(parts, channel, &exr::Part::channel);
        const bool there = part != parts.end() && (part->format == PixelFormat::id) == !std::is_same_v<Value, float>;
        if (!there || count > rows() || first > rows() - count)
            refuse(fmt::format("it lacks {} in rows {} to {}", name_of_channel(channel), first, first + count));
        values.resize(count * header.size[0] * components_of(channel));
        if (count > 0)
            exr::read_rows(image, static_cast<std::size_t>(part - parts.begin()), *part, first, count,
                           std::as_writable_bytes(std::span(values)).data());
    }

    std::filesystem::path path;
    ReadableFile file;
    exr::Image image;
    VolumeHeader header;
    std::vector<exr::Part> parts;
};

VolumeHeader VolumeReader::State::read_header() const {
    VolumeHeader found;
    const exr::Layer& first = image.layers().front();
    const auto require = [&](auto value, const char* name) {
        if (!value)
            refuse(fmt::format("it lacks {}", name));
        return *value;
    };
    const auto text = [&](const char* name) { return require(image.text(name), name); };
    const auto vector = [&](const char* name) {
        const auto value = require(image.vector(name), name);
        return std::array{value.x, value.y, value.z};
    };
    const auto grid = require(image.integers("forceshade.grid"), "forceshade.grid");
    if (grid.x < 1 || grid.y < 1 || grid.z < 1)
        refuse("it lacks forceshade.grid");
    found.size = {static_cast<std::uint64_t>(grid.x), static_cast<std::uint64_t>(grid.y),
                  static_cast<std::uint64_t>(grid.z)};
    found.origin = vector("forceshade.origin");
    found.spacing = vector("forceshade.spacing");
    found.scene = text("forceshade.scene");
    found.version = text("forceshade.version");
    found.omitted = text("forceshade.omitted");
    found.place_origin = exr::place_origin_of(image);
    const auto compression = exr::compression_from(first.compression);
    if (!compression)
        refuse("its compression is another");
    found.compression = *compression;
    const auto red = first.find("R");
    found.pixel = red && first.channels[*red].type == EXR_PIXEL_HALF ? PixelType::half : PixelType::float32;
    found.channels = 0;
    for (const exr::Layer& layer : image.layers())
        for (const std::uint32_t channel : kFieldChannels)
            found.channels |= layer.name == name_of_channel(channel) ? channel : 0;
    if (!(found.channels & layout::kChannelForce) || exr::parts_of(found).size() != image.layers().size())
        refuse("its parts are others");
    try {
        exr::require_possible(found);
    } catch (const UsageError& error) {
        refuse(error.what());
    }
    return found;
}

VolumeReader::VolumeReader(const std::filesystem::path& path) : state_(std::make_unique<State>(path)) {}
VolumeReader::~VolumeReader() = default;

const VolumeHeader& VolumeReader::header() const noexcept {
    return state_->header;
}
std::uint64_t VolumeReader::rows() const noexcept {
    return state_->rows();
}

void VolumeReader::read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, std::vector<float>& values) {
    state_->read(channel, first, count, values);
}

void VolumeReader::read_ids(std::uint64_t first, std::uint64_t count, std::vector<std::uint32_t>& ids) {
    state_->read(layout::kChannelFacet, first, count, ids);
}

bool holds_paths(const std::filesystem::path& path) {
    const ReadableFile file(path);
    const exr::Image image(file, path);
    return std::ranges::find(image.layers(), name_of_channel(layout::kChannelPosition), &exr::Layer::name) !=
           image.layers().end();
}

PathSamples read_paths(const std::filesystem::path& path, std::uint64_t most_paths, std::uint64_t most_steps,
                       bool scalars) {
    const ReadableFile file(path);
    exr::Image image(file, path);
    const auto refuse = [&](const std::string& why) {
        throw IoError("cannot read {}: it holds no paths of this program, {}", path.string(), why);
    };
    const exr::Layer& first = image.layers().front();
    const std::uint64_t columns = first.columns(), rows = first.rows();
    PathSamples read;
    read.scene = image.text("forceshade.scene").value_or("");
    read.origin = exr::place_origin_of(image);
    read.paths_in_file = rows;
    const std::uint64_t every_path = read.every_path = (rows + most_paths - 1) / most_paths;
    read.every_step = (columns + most_steps - 1) / most_steps;
    read.paths = (rows + every_path - 1) / every_path;
    read.steps = (columns + read.every_step - 1) / read.every_step;
    const auto add = [&]<typename Value>(std::uint32_t channel, std::vector<Value>& values, bool required) {
        const auto layer = std::ranges::find(image.layers(), name_of_channel(channel), &exr::Layer::name);
        if (layer == image.layers().end()) {
            if (required)
                refuse(fmt::format("it lacks {}", name_of_channel(channel)));
            return;
        }
        const auto real =
            std::ranges::find_if(layer->channels, [](const exr::Channel& one) { return one.type == EXR_PIXEL_HALF; });
        const bool half = real != layer->channels.end();
        const exr::Part part = exr::make_part(channel, half ? PixelType::half : PixelType::float32, Compression::none);
        if (!exr::has_layout(*layer, part, columns, rows))
            refuse(fmt::format("its part {} has another layout", layer->name));
        const auto components = static_cast<std::ptrdiff_t>(components_of(channel));
        std::vector<Value> row(static_cast<std::size_t>(components) * columns);
        for (std::uint64_t at = 0; at < rows; at += every_path) {
            exr::read_rows(image, static_cast<std::size_t>(layer - image.layers().begin()), part, at, 1,
                           std::as_writable_bytes(std::span(row)).data());
            for (std::uint64_t step = 0; step < columns; step += read.every_step) {
                const auto sample = row.begin() + components * static_cast<std::ptrdiff_t>(step);
                values.insert(values.end(), sample, sample + components);
            }
        }
    };
    add(layout::kChannelForce, read.force, true);
    add(layout::kChannelPosition, read.position, true);
    add(layout::kChannelProxy, read.proxy, false);
    if (scalars) {
        add(layout::kChannelDepth, read.depth, false);
        add(layout::kChannelFacet, read.facet, false);
        add(kChannelAngle, read.angle, false);
        add(kChannelMagnitudeError, read.magnitude_error, false);
    }
    return read;
}

} // namespace forceshade
