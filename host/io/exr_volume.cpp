#include "host/io/exr_volume.h"

#include <algorithm>
#include <array>
#include <mutex>

#include <ImfChannelList.h>
#include <ImfPartType.h>
#include <ImfStringAttribute.h>
#include <ImfThreading.h>
#include <ImfVecAttribute.h>
#include <fmt/core.h>

#include "host/error.h"
#include "host/io/chunk_rows.h"
#include "host/io/exr_parts.h"
#include "host/io/hash.h"
#include "host/scene/limits.h"

namespace forceshade {
namespace exr {
namespace {

constexpr std::array kChannels{layout::kChannelForce, layout::kChannelDepth, layout::kChannelFacet,
                               layout::kChannelProxy, layout::kChannelUnshaded};
constexpr std::uint64_t kBlockRows = 16; // of ZIP and PXR24; the others have fewer

const char* unit_of(std::uint32_t channel) {
    if (channel == layout::kChannelFacet)
        return "1";
    return channel == layout::kChannelForce || channel == layout::kChannelUnshaded ? "N" : "m";
}

PixelFormat format_of(std::uint32_t channel, const VolumeHeader& header) {
    if (channel == layout::kChannelFacet)
        return PixelFormat::id;
    if (header.pixel == PixelType::half)
        return PixelFormat::half;
    return header.compression == Compression::pxr24 ? PixelFormat::float24 : PixelFormat::float32;
}

Imf::Compression compression_of(Compression compression) {
    switch (compression) {
    case Compression::none:
        return Imf::NO_COMPRESSION;
    case Compression::zip1:
        return Imf::ZIPS_COMPRESSION;
    case Compression::pxr24:
        return Imf::PXR24_COMPRESSION;
    case Compression::zip:
        break;
    }
    return Imf::ZIP_COMPRESSION;
}

Imf::PixelType pixel_of(PixelFormat format) {
    if (format == PixelFormat::id)
        return Imf::UINT;
    return format == PixelFormat::half ? Imf::HALF : Imf::FLOAT;
}

} // namespace

std::vector<Part> parts_of(const VolumeHeader& header) {
    std::vector<Part> parts;
    for (const std::uint32_t channel : kChannels) {
        if (channel != layout::kChannelForce && !(header.channels & channel))
            continue;
        std::vector<const char*> names{"R", "G", "B"};
        if (components_of(channel) == 1)
            names = {channel == layout::kChannelFacet ? "id" : "Z"};
        parts.push_back({channel, std::move(names), unit_of(channel), format_of(channel, header)});
    }
    return parts;
}

void require_possible(const VolumeHeader& header) {
    const auto [nx, ny, nz] = header.size;
    if (nx == 0 || ny == 0 || nz == 0)
        throw UsageError(
            fmt::format("a grid of {} x {} x {} samples is empty: every size must be 1 or more", nx, ny, nz));
    if (ny > kMostRows / nz)
        throw UsageError(fmt::format("a grid of {} x {} x {} samples has more than the {} rows (y times z) that an EXR "
                                     "holds: make it smaller",
                                     nx, ny, nz, kMostRows));
    if (nx > kMostColumns)
        throw UsageError(fmt::format(
            "a grid of {} samples along x is wider than the {} that an EXR holds: make it smaller", nx, kMostColumns));
}

Imf::Header make_image_header(const Part& part, std::uint64_t width, std::uint64_t rows, Compression compression) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(rows), 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y,
                       compression_of(compression));
    header.setName(name_of_channel(part.channel));
    header.setType(Imf::SCANLINEIMAGE);
    for (const char* name : part.channels)
        header.channels().insert(name, Imf::Channel(pixel_of(part.format)));
    return header;
}

void insert_text(Imf::Header& header, const Part& part, const std::string& scene, const std::string& version,
                 const std::string& omitted) {
    header.insert("forceshade.units", Imf::StringAttribute(std::string("m ") + part.unit));
    header.insert("forceshade.scene", Imf::StringAttribute(scene));
    header.insert("forceshade.version", Imf::StringAttribute(version));
    header.insert("forceshade.omitted", Imf::StringAttribute(omitted));
}

Imf::Header make_header(const Part& part, const VolumeHeader& volume) {
    Imf::Header header = make_image_header(part, volume.size[0], volume.size[1] * volume.size[2], volume.compression);
    const auto vector_of = [](const std::array<double, 3>& v) { return Imf::V3dAttribute({v[0], v[1], v[2]}); };
    const auto size_of = [&](int axis) { return static_cast<int>(volume.size[static_cast<std::size_t>(axis)]); };
    header.insert("forceshade.grid", Imf::V3iAttribute({size_of(0), size_of(1), size_of(2)}));
    header.insert("forceshade.origin", vector_of(volume.origin));
    header.insert("forceshade.spacing", vector_of(volume.spacing));
    insert_text(header, part, volume.scene, volume.version, volume.omitted);
    return header;
}

Imf::FrameBuffer frame_of(const Part& part, std::uint64_t width, std::uint64_t first, std::uint64_t count,
                          const std::byte* bytes) {
    Imf::FrameBuffer frame;
    const Imath::V2i corner(0, static_cast<int>(first));
    for (std::size_t c = 0; c < part.channels.size(); ++c)
        frame.insert(part.channels[c],
                     Imf::Slice::Make(pixel_of(part.format), bytes + c * bytes_of(part.format), corner,
                                      static_cast<std::int64_t>(width), static_cast<std::int64_t>(count),
                                      part.sample_bytes(), part.sample_bytes() * width));
    return frame;
}

std::uint64_t rows_per_group(std::uint64_t width, std::uint64_t rows) {
    constexpr std::uint64_t kGroupBytes = 4 << 20;
    const std::uint64_t most = kGroupBytes / (width * 3 * sizeof(float));
    return std::min(std::max(most / kBlockRows, std::uint64_t{1}) * kBlockRows,
                    (rows + kBlockRows - 1) / kBlockRows * kBlockRows);
}

void require_workers(int threads) {
    static std::mutex mutex;
    const std::lock_guard lock(mutex);
    if (Imf::globalThreadCount() < threads)
        Imf::setGlobalThreadCount(threads);
}

} // namespace exr

} // namespace forceshade
