#include "host/output/exr_paths.h"

#include <cstring>
#include <limits>
#include <stdexcept>
#include <vector>

#include <ImfDoubleAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/core.h>

#include "host/error.h"
#include "host/output/exr_writer.h"
#include "host/output/rows.h"
#include "host/scene/scene.h"

namespace forceshade {

namespace {

constexpr std::array kChannels{layout::kChannelForce, layout::kChannelPosition, layout::kChannelDepth,
                               layout::kChannelFacet, layout::kChannelProxy};

void require_possible(const PathVolumeHeader& header) {
    if (header.steps == 0 || header.paths == 0)
        throw UsageError("there are no paths to write");
    if (header.steps > kMostColumns)
        throw UsageError(
            fmt::format("paths of {} steps are longer than the {} that an EXR holds: write a .csv file, or "
                        "make them shorter",
                        header.steps, kMostColumns));
    if (header.paths > kMostRows)
        throw UsageError(fmt::format("{} paths are more than the {} that an EXR holds: write fewer to a file",
                                     header.paths, kMostRows));
}

// Coarser numbers would do to forces; positions are read against each other.
bool is_exact(std::uint32_t channel) {
    return channel == layout::kChannelPosition || channel == layout::kChannelProxy;
}

PixelFormat format_of(std::uint32_t channel, const PathVolumeHeader& header) {
    if (channel == layout::kChannelFacet)
        return PixelFormat::id;
    if (is_exact(channel))
        return PixelFormat::float32;
    if (header.pixel == PixelType::half)
        return PixelFormat::half;
    return header.compression == Compression::pxr24 ? PixelFormat::float24 : PixelFormat::float32;
}

exr::Part part_of(std::uint32_t channel, const PathVolumeHeader& header) {
    std::vector<const char*> names{"R", "G", "B"};
    if (components_of(channel) == 1)
        names = {channel == layout::kChannelFacet ? "id" : "Z"};
    const char* unit = channel == layout::kChannelFacet ? "1" : channel == layout::kChannelForce ? "N" : "m";
    return {channel, std::move(names), unit, format_of(channel, header)};
}

exr::Sheet sheet_of(const PathVolumeHeader& header) {
    require_possible(header);
    exr::Sheet sheet{header.steps, header.paths, {}, {}, header.threads};
    for (const std::uint32_t channel : kChannels) {
        if (!(header.channels & channel) && channel != layout::kChannelForce && channel != layout::kChannelPosition)
            continue;
        const exr::Part part = part_of(channel, header);
        const bool lossy = header.compression == Compression::pxr24;
        Imf::Header image = exr::make_image_header(part, header.steps, header.paths,
                                                   lossy && is_exact(channel) ? Compression::zip : header.compression);
        image.insert("forceshade.paths",
                     Imf::V2iAttribute({static_cast<int>(header.steps), static_cast<int>(header.paths)}));
        if (header.rate > 0)
            image.insert("forceshade.rate", Imf::DoubleAttribute(header.rate));
        exr::insert_text(image, part, header.scene, header.version, header.omitted);
        sheet.parts.push_back(part);
        sheet.headers.push_back(image);
    }
    return sheet;
}

} // namespace

template <typename T> std::span<const T> values_of(const PathRows<T>& rows, std::uint32_t channel) {
    const std::span<const T> values = channel == layout::kChannelForce      ? rows.force
                                      : channel == layout::kChannelPosition ? rows.position
                                      : channel == layout::kChannelDepth    ? rows.depth
                                                                            : rows.proxy;
    if (values.size() < rows.path_count * rows.pitch * components_of(channel))
        throw std::logic_error(fmt::format("paths lack samples of channel {}", name_of_channel(channel)));
    return values;
}
template std::span<const float> values_of(const PathRows<float>&, std::uint32_t);
template std::span<const double> values_of(const PathRows<double>&, std::uint32_t);

struct PathVolumeWriter::State {
    State(const std::filesystem::path& path, const PathVolumeHeader& from)
        : header(from), rows(path, sheet_of(from), false) {}

    template <typename T> void write(const PathRows<T>& paths) {
        if (paths.path_first != next || paths.step_first != step || paths.step_first + paths.pitch > header.steps ||
            next + paths.path_count > header.paths)
            throw std::logic_error(fmt::format("step {} of path {} is not what follows step {} of {}", paths.step_first,
                                               paths.path_first, step, next));
        const exr::Stopwatch stopwatch(rows.timings.encode);
        for (std::size_t path = 0; path < paths.path_count; ++path) {
            for (exr::PartRows& part : rows.parts())
                convert_row(paths, path, part);
            step = paths.step_first + paths.pitch;
            if (!paths.ends(path))
                continue;
            rows.advance();
            step = 0;
            ++next;
        }
    }

    // The samples, and where the path ends with them what fills its row up.
    template <typename T> void convert_row(const PathRows<T>& paths, std::size_t path, exr::PartRows& part) {
        const std::size_t components = components_of(part.part.channel);
        const std::size_t first = path * paths.pitch, samples = paths.samples(path);
        const std::size_t width = paths.ends(path) ? header.steps - paths.step_first : samples;
        std::byte* const target = rows.target(part) + paths.step_first * part.part.sample_bytes();
        if (part.part.format == PixelFormat::id) {
            ids.assign(width, layout::kNoFacet);
            std::copy_n(paths.facet.begin() + static_cast<std::ptrdiff_t>(first), samples, ids.begin());
            std::memcpy(target, ids.data(), ids.size() * sizeof(layout::uint));
            return;
        }
        const std::span<const T> values = values_of(paths, part.part.channel).subspan(first * components);
        rounded.assign(width * components, std::numeric_limits<float>::quiet_NaN());
        for (std::size_t i = 0; i < samples * components; ++i)
            rounded[i] = static_cast<float>(values[i]);
        part.watch.add(std::span(rounded).first(samples * components), paths.path_first + path, 0, 1, paths.step_first);
        encode_row(rounded, part.part.format, target);
    }

    PathVolumeHeader header;
    exr::RowsWriter rows;
    std::uint64_t next = 0;        // path
    std::uint64_t step = 0;        // of it, the next
    std::vector<float> rounded;    // a row, or a part of one
    std::vector<layout::uint> ids; // likewise
};

PathVolumeWriter::PathVolumeWriter(const std::filesystem::path& path, const PathVolumeHeader& header)
    : state_(std::make_unique<State>(path, header)) {}
PathVolumeWriter::~PathVolumeWriter() = default;

void PathVolumeWriter::write(const PathRows<float>& rows) {
    state_->write(rows);
}
void PathVolumeWriter::write(const PathRows<double>& rows) {
    state_->write(rows);
}

VolumeResult PathVolumeWriter::finish() {
    if (state_->next != state_->header.paths)
        throw std::logic_error(fmt::format("only {} of {} paths were written", state_->next, state_->header.paths));
    return state_->rows.finish([](const Voxel& at) { return fmt::format("step {} of path {}", at[0], at[1]); });
}

} // namespace forceshade
