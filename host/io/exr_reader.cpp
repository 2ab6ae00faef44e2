#include <algorithm>
#include <cstring>
#include <span>

#include <ImfChannelList.h>
#include <ImfInputPart.h>
#include <ImfMultiPartInputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/core.h>

#include "host/error.h"
#include "host/io/chunk_rows.h"
#include "host/io/exr_parts.h"
#include "host/io/exr_scan.h"
#include "host/io/exr_stream.h"
#include "host/io/exr_volume.h"
#include "host/io/readable_file.h"

namespace forceshade {

struct VolumeReader::State {
    State(const std::filesystem::path& path_, int threads);

    VolumeHeader read_header(int threads) const;
    void require_alike(const Imf::Header& found, const exr::Part& part) const;
    [[noreturn]] void foreign(const std::string& what) const;
    void read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, bool ids, std::byte* target);

    std::filesystem::path path;
    ReadableFile file;
    exr::ReadStream stream;
    std::unique_ptr<Imf::MultiPartInputFile> input;
    VolumeHeader header;
    std::vector<exr::Part> parts;
};

namespace {

Compression compression_from(Imf::Compression compression) {
    switch (compression) {
    case Imf::NO_COMPRESSION:
        return Compression::none;
    case Imf::ZIPS_COMPRESSION:
        return Compression::zip1;
    case Imf::PXR24_COMPRESSION:
        return Compression::pxr24;
    default:
        return Compression::zip;
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
    : path(path_), file(path_), stream(file, path_) {
    exr::require_plausible(file, path);
    exr::require_workers(threads);
    exr::guarded(stream, "read", path, [&] {
        input = std::make_unique<Imf::MultiPartInputFile>(stream, threads, false);
        header = read_header(threads);
    });
    parts = exr::parts_of(header);
    for (std::size_t i = 0; i < parts.size(); ++i)
        require_alike(input->header(static_cast<int>(i)), parts[i]);
}

VolumeHeader VolumeReader::State::read_header(int threads) const {
    VolumeHeader found;
    const Imf::Header& first = input->header(0);
    const auto text = [&](const char* name) {
        const auto* attribute = first.findTypedAttribute<Imf::StringAttribute>(name);
        if (!attribute)
            foreign(fmt::format("it lacks {}", name));
        return attribute->value();
    };
    const auto vector = [&](const char* name) {
        const auto* attribute = first.findTypedAttribute<Imf::V3dAttribute>(name);
        if (!attribute)
            foreign(fmt::format("it lacks {}", name));
        return std::array{attribute->value().x, attribute->value().y, attribute->value().z};
    };
    const auto* grid = first.findTypedAttribute<Imf::V3iAttribute>("forceshade.grid");
    if (!grid || grid->value().x < 1 || grid->value().y < 1 || grid->value().z < 1)
        foreign("it lacks forceshade.grid");
    for (int axis = 0; axis < 3; ++axis)
        found.size[static_cast<std::size_t>(axis)] = static_cast<std::uint64_t>(grid->value()[axis]);
    found.origin = vector("forceshade.origin");
    found.spacing = vector("forceshade.spacing");
    found.scene = text("forceshade.scene");
    found.version = text("forceshade.version");
    found.omitted = text("forceshade.omitted");
    found.threads = threads;
    found.compression = compression_from(first.compression());
    const Imf::Channel* red = first.channels().findChannel("R");
    found.pixel = red && red->type == Imf::HALF ? PixelType::half : PixelType::float32;
    found.channels = 0;
    for (int part = 0; part < input->parts(); ++part)
        found.channels |= input->header(part).hasName() ? channel_named(input->header(part).name()) : 0;
    if (!(found.channels & layout::kChannelForce) ||
        exr::parts_of(found).size() != static_cast<std::size_t>(input->parts()))
        foreign("its parts are others");
    return found;
}

void VolumeReader::State::require_alike(const Imf::Header& found, const exr::Part& part) const {
    exr::guarded(stream, "read", path, [&] {
        try {
            exr::require_possible(header);
        } catch (const UsageError& error) {
            foreign(error.what());
        }
        const Imf::Header expected = exr::make_header(part, header);
        if (found.dataWindow() != expected.dataWindow())
            foreign("its data window does not fit its grid");
        if (!(found.channels() == expected.channels()) || found.compression() != expected.compression() ||
            found.name() != expected.name() || (found.hasType() && found.type() != expected.type()))
            foreign(fmt::format("its part {} is laid out in another way", expected.name()));
    });
}

void VolumeReader::State::read(std::uint32_t channel, std::uint64_t first, std::uint64_t count, bool ids,
                               std::byte* target) {
    const auto found = std::ranges::find(parts, channel, &exr::Part::channel);
    exr::Part part = *found;
    part.format = ids ? PixelFormat::id : PixelFormat::float32; // OpenEXR widens halves
    exr::guarded(stream, "read", path, [&] {
        Imf::InputPart pixels(*input, static_cast<int>(found - parts.begin()));
        pixels.setFrameBuffer(exr::frame_of(part, header.size[0], first, count, target));
        pixels.readPixels(static_cast<int>(first), static_cast<int>(first + count - 1));
    });
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
        state_->read(channel, first, count, false, std::as_writable_bytes(std::span(values)).data());
}

void VolumeReader::read_ids(std::uint64_t first, std::uint64_t count, std::vector<std::uint32_t>& ids) {
    if (!(state_->header.channels & layout::kChannelFacet) || count > rows() || first > rows() - count)
        state_->foreign(fmt::format("it lacks facet in rows {} to {}", first, first + count));
    ids.resize(count * state_->header.size[0]);
    if (count > 0)
        state_->read(layout::kChannelFacet, first, count, true, std::as_writable_bytes(std::span(ids)).data());
}

} // namespace forceshade
