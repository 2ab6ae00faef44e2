#include "host/output/exr_writer.h"

#include <algorithm>
#include <array>
#include <chrono>
#include <cstring>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include <ImfDoubleAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/core.h>

#include "host/error.h"
#include "host/output/exr_volume.h"
#include "host/output/rows.h"

namespace forceshade::exr {

namespace {

double now() {
    return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

} // namespace

Stopwatch::Stopwatch(double& sum) : sum_(sum), start_(now()) {}
Stopwatch::~Stopwatch() {
    sum_ += now() - start_;
}

PartRows::PartRows(const Part& part_, std::size_t bytes)
    : part(part_), rows(bytes), watch(components_of(part.channel)) {}

RowsWriter::RowsWriter(const std::filesystem::path& path, Sheet sheet, bool allow_non_finite)
    : sheet_(std::move(sheet)), allow_non_finite_(allow_non_finite), file_(path), stream_(file_),
      group_rows_(rows_per_group(sheet_.width, sheet_.rows)) {
    require_workers(sheet_.threads);
    for (const Part& part : sheet_.parts)
        parts_.emplace_back(part, std::min(group_rows_, sheet_.rows) * sheet_.width * part.sample_bytes());
    guarded(stream_, "write", path, [&] {
        output_ = std::make_unique<Imf::MultiPartOutputFile>(
            stream_, sheet_.headers.data(), static_cast<int>(sheet_.headers.size()), false, sheet_.threads);
        for (std::size_t i = 0; i < parts_.size(); ++i)
            parts_[i].output.emplace(*output_, static_cast<int>(i));
    });
}

void RowsWriter::advance() {
    if (++group_count_ == group_rows_)
        flush_group();
}

void RowsWriter::repeat() {
    const std::uint64_t previous = (group_count_ + group_rows_ - 1) % group_rows_; // a full group stays in memory
    for (PartRows& rows : parts_)
        std::memmove(target(rows), rows.rows.data() + previous * row_bytes(rows), row_bytes(rows));
    advance();
}

// An image that will be refused is only watched to its end, so that the message can name its largest value.
void RowsWriter::flush_group() {
    for (PartRows& rows : parts_) {
        if (refused() || group_count_ == 0)
            break;
        rows.checksum.update(std::span(rows.rows).first(group_count_ * row_bytes(rows)));
        guarded(stream_, "write", file_.path(), [&] {
            rows.output->setFrameBuffer(
                frame_of(rows.part, sheet_.width, group_first_, group_count_, rows.rows.data()));
            rows.output->writePixels(static_cast<int>(group_count_));
        });
    }
    group_first_ += group_count_;
    group_count_ = 0;
}

bool RowsWriter::refused() const {
    for (const PartRows& rows : parts_) {
        if (rows.watch.non_finite() > 0 && !allow_non_finite_)
            return true;
        if (rows.part.format == PixelFormat::half && overflows_half(static_cast<float>(rows.watch.largest().value)))
            return true;
    }
    return false;
}

void RowsWriter::throw_if_refused(const std::function<std::string(const Voxel&)>& place) const {
    for (const PartRows& rows : parts_) {
        const auto& [value, at, found] = rows.watch.first_non_finite();
        if (found && !allow_non_finite_)
            throw Error(ExitCode::failed,
                        fmt::format("{}: {} is {} at {}: {} values are not finite as floats; nothing was written",
                                    file_.path().string(), name_of_channel(rows.part.channel), value, place(at),
                                    rows.watch.non_finite()));
    }
    for (const PartRows& rows : parts_) {
        const auto& [value, at, found] = rows.watch.largest();
        if (rows.part.format == PixelFormat::half && overflows_half(static_cast<float>(value)))
            throw UsageError(fmt::format("{}: half cannot hold {:.6g} {} at {}, its largest is 65504: write "
                                         "pixel = \"float\"",
                                         file_.path().string(), static_cast<float>(value), rows.part.unit, place(at)));
    }
}

// OpenEXR writes the blocks' offsets from destructors, which swallow what goes wrong; but after a failure the file
// cannot be flushed or published any more.
void RowsWriter::close() {
    flush_group();
    for (PartRows& rows : parts_)
        rows.output.reset();
    output_.reset();
}

void RowsWriter::read_back() {
    const std::vector<std::uint64_t> found = checksums_of(file_.temporary_path(), file_.path(), sheet_);
    for (std::size_t i = 0; i < parts_.size(); ++i)
        if (found.size() != parts_.size() || found[i] != parts_[i].checksum.value())
            throw IoError(fmt::format("cannot write {}: read back from the disk, the part {} differs from what was "
                                      "written; check the disk and the memory",
                                      file_.path().string(), name_of_channel(parts_[i].part.channel)));
}

VolumeResult RowsWriter::finish(const std::function<std::string(const Voxel&)>& place) {
    throw_if_refused(place);
    VolumeResult result;
    {
        const Stopwatch stopwatch(timings.encode);
        close();
    }
    {
        const Stopwatch stopwatch(timings.flush);
        file_.flush_to_disk();
    }
    {
        const Stopwatch stopwatch(timings.read_back);
        read_back();
    }
    {
        const Stopwatch stopwatch(timings.hash);
        result.sha256 = sha256_of_file(file_.temporary_path());
        result.bytes = std::filesystem::file_size(file_.temporary_path());
    }
    {
        const Stopwatch stopwatch(timings.flush);
        file_.publish();
    }
    result.timings = timings;
    const WatchedValue& longest = parts_.front().watch.longest();
    result.largest_force = longest.value;
    result.largest_voxel = longest.voxel;
    for (const PartRows& rows : parts_)
        result.non_finite += rows.watch.non_finite();
    return result;
}

} // namespace forceshade::exr

namespace forceshade {

namespace {

exr::Sheet sheet_of(const VolumeHeader& volume) {
    exr::require_possible(volume);
    exr::Sheet sheet{volume.size[0], volume.size[1] * volume.size[2], exr::parts_of(volume), {}, volume.threads};
    for (const exr::Part& part : sheet.parts)
        sheet.headers.push_back(exr::make_header(part, volume));
    return sheet;
}

} // namespace

struct VolumeWriter::State {
    State(const std::filesystem::path& path, const VolumeHeader& volume)
        : rows(path, sheet_of(volume), volume.allow_non_finite), order(volume.size) {}

    template <typename real> void write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y);
    VolumeResult finish();

private:
    template <typename real>
    void convert_row(const layout::FieldChunk<real>& chunk, std::size_t row, std::size_t repeat, exr::PartRows& part);

    exr::RowsWriter rows;
    RowOrder order;
    std::vector<float> rounded; // one row of doubles, as floats
};

template <typename real> void VolumeWriter::State::write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
    const exr::Stopwatch stopwatch(rows.timings.encode);
    order.accept(chunk, repeat_y);
    for (std::size_t row = 0; row < chunk.z_count * chunk.y_count; ++row) {
        for (exr::PartRows& part : rows.parts())
            convert_row(chunk, row, repeat_y, part);
        rows.advance();
        for (std::size_t copy = 1; copy < repeat_y; ++copy)
            rows.repeat();
    }
}

template <typename real>
void VolumeWriter::State::convert_row(const layout::FieldChunk<real>& chunk, std::size_t row, std::size_t repeat,
                                      exr::PartRows& part) {
    std::byte* target = rows.target(part);
    const std::size_t components = components_of(part.part.channel);
    const std::size_t first = row * chunk.x_pitch * components, count = chunk.x_count * components;
    if (part.part.format == PixelFormat::id) {
        std::memcpy(target, ids_of(chunk).subspan(first, count).data(), count * sizeof(layout::uint));
        return;
    }
    const std::span<const real> values = values_of(chunk, part.part.channel).subspan(first, count);
    std::span<const float> floats;
    if constexpr (std::is_same_v<real, float>) {
        floats = values;
    } else {
        rounded.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            rounded[i] = static_cast<float>(values[i]);
        floats = rounded;
    }
    part.watch.add(floats, chunk.y_first + row % chunk.y_count, chunk.z_first + row / chunk.y_count, repeat);
    encode_row(floats, part.part.format, target);
}

VolumeResult VolumeWriter::State::finish() {
    order.require_complete();
    return rows.finish(
        [](const Voxel& voxel) { return fmt::format("voxel ({}, {}, {})", voxel[0], voxel[1], voxel[2]); });
}

VolumeWriter::VolumeWriter(const std::filesystem::path& path, const VolumeHeader& header)
    : state_(std::make_unique<State>(path, header)) {}
VolumeWriter::~VolumeWriter() = default;

void VolumeWriter::write(const AnyFieldChunk& any, std::size_t repeat_y) {
    std::visit([&](const auto& chunk) { state_->write(chunk, repeat_y); }, any);
}

VolumeResult VolumeWriter::finish() {
    return state_->finish();
}

namespace {

constexpr std::array kPathChannels{layout::kChannelForce, layout::kChannelPosition, layout::kChannelDepth,
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

exr::Sheet sheet_of(const PathVolumeHeader& header) {
    require_possible(header);
    exr::Sheet sheet{header.steps, header.paths, {}, {}, header.threads};
    for (const std::uint32_t channel : kPathChannels) {
        if (!(header.channels & channel) && channel != layout::kChannelForce && channel != layout::kChannelPosition)
            continue;
        const bool exact = is_exact(channel);
        const Compression compression =
            exact && header.compression == Compression::pxr24 ? Compression::zip : header.compression;
        const exr::Part part = exr::make_part(channel, exact ? PixelType::float32 : header.pixel, compression);
        Imf::Header image = exr::make_image_header(part, header.steps, header.paths, compression);
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

void PathVolumeWriter::write(const AnyPathRows& any) {
    std::visit([&](const auto& rows) { state_->write(rows); }, any);
}

VolumeResult PathVolumeWriter::finish() {
    if (state_->next != state_->header.paths)
        throw std::logic_error(fmt::format("only {} of {} paths were written", state_->next, state_->header.paths));
    return state_->rows.finish([](const Voxel& at) { return fmt::format("step {} of path {}", at[0], at[1]); });
}

} // namespace forceshade
