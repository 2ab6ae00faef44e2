#include "host/output/exr_volume.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <functional>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfPartType.h>
#include <ImfStdIO.h>
#include <ImfStringAttribute.h>
#include <ImfVecAttribute.h>
#include <fmt/core.h>

#include "host/clock.h"
#include "host/error.h"
#include "host/output/exr_image.h"
#include "host/output/files.h"
#include "host/output/raw_formats.h"
#include "host/output/rows.h"
#include "host/program.h"
#include "host/threads.h"

namespace forceshade {

namespace {

using exr::Part;

constexpr std::uint64_t kBlockRows = 16; // of ZIP and PXR24; the others have fewer

// An image of several parts, ready to be written.
struct Sheet {
    std::uint64_t width = 0, rows = 0;
    std::vector<Part> parts;
    std::vector<Compression> compressions; /* of the parts */
    std::vector<Imf::Header> headers;      /* of the parts */
    int threads = 0;                       /* that compress this file; 0: it asks for no parallel work */

    void add(const Part& part, Compression compression, Imf::Header header) {
        parts.push_back(part);
        compressions.push_back(compression);
        headers.push_back(std::move(header));
    }
};

// Rows that are packed at once: a multiple of every compression's block, about 4 MiB of force. It decides
// how the parts' blocks interleave in the file, so it may depend on the image's size alone.
std::uint64_t rows_per_group(std::uint64_t width, std::uint64_t rows) {
    constexpr std::uint64_t kGroupBytes = 4 << 20;
    const std::uint64_t most = kGroupBytes / (width * 3 * sizeof(float));
    return std::min(std::max(most / kBlockRows, std::uint64_t{1}) * kBlockRows,
                    (rows + kBlockRows - 1) / kBlockRows * kBlockRows);
}

Imf::PixelType pixel_of(PixelFormat format) {
    if (format == PixelFormat::id)
        return Imf::UINT;
    return format == PixelFormat::half ? Imf::HALF : Imf::FLOAT;
}

// The part's header, without its grid or paths. It depends neither on the day nor on the machine.
Imf::Header make_header(const Part& part, std::uint64_t width, std::uint64_t rows, Compression compression,
                        const ExrOptions& options) {
    Imf::Header header(static_cast<int>(width), static_cast<int>(rows), 1.0f, Imath::V2f(0, 0), 1.0f, Imf::INCREASING_Y,
                       Imf::Compression(exr::kCompressions[static_cast<std::size_t>(compression)]));
    header.setName(name_of_channel(part.channel));
    header.setType(Imf::SCANLINEIMAGE);
    for (const char* name : part.channels)
        header.channels().insert(name, Imf::Channel(pixel_of(part.format)));
    header.insert("forceshade.units", Imf::StringAttribute(std::string("m ") + part.unit));
    header.insert("forceshade.scene", Imf::StringAttribute(options.scene));
    header.insert("forceshade.version", Imf::StringAttribute(options.version));
    header.insert("forceshade.omitted", Imf::StringAttribute(options.omitted));
    return header;
}

Imf::V3dAttribute attribute_of(double x, double y, double z) {
    return Imf::V3dAttribute(Imath::V3d(x, y, z));
}

// Only where it says something.
void add_place_origin(Imf::Header& header, const glm::dvec3& origin) {
    if (origin != glm::dvec3(0))
        header.insert("forceshade.place_origin", attribute_of(origin.x, origin.y, origin.z));
}

// The file up to its blocks, whose offsets are still 0.
std::string beginning_of(const std::vector<Imf::Header>& headers) {
    Imf::StdOSStream stream;
    { const Imf::MultiPartOutputFile begun(stream, headers.data(), static_cast<int>(headers.size()), false, 0); }
    return stream.str();
}

// The rows of one part on their way to its blocks.
struct PartRows {
    PartRows(const Part& part_, exr::BlockPacker packer_, std::size_t bytes)
        : part(part_), packer(std::move(packer_)), rows(bytes), handed(bytes), watch(components_of(part.channel)) {}

    Part part;
    exr::BlockPacker packer;
    std::vector<std::byte> rows;   // a group
    std::vector<std::byte> handed; // the group before, which may still be packed
    PixelWatch watch;
    std::vector<std::uint64_t> offsets; // byte of the file: of its blocks
};

using PlaceText = std::function<std::string(const Voxel&)>;

// The rows of an image of several parts, packed group by group, and read back before the file gets its name. Memory is
// two groups of rows a part, and one packed. The bytes of the file depend on the sheet and the rows alone.
class RowsWriter {
public:
    // Throws IoError.
    RowsWriter(const std::filesystem::path& path, const Sheet& sheet)
        : width_(sheet.width), threads_(static_cast<std::size_t>(std::max(sheet.threads, 1))),
          in_parallel_(sheet.threads > 0), file_(path), group_rows_(rows_per_group(sheet.width, sheet.rows)),
          scratch_(threads_) {
        for (std::size_t i = 0; i < sheet.parts.size(); ++i) {
            const Part& part = sheet.parts[i];
            parts_.emplace_back(part, exr::BlockPacker(part, width_, sheet.compressions[i]),
                                std::min(group_rows_, sheet.rows) * width_ * part.sample_bytes());
        }
        file_.write(beginning_of(sheet.headers));
        data_from_ = file_.tell();
    }

    std::vector<PartRows>& parts() noexcept { return parts_; }
    // Reals of the part's next row from sample at[0] on, which stands `repeat` times; up to `width` samples NaN follow.
    template <typename T>
    void put(PartRows& rows, std::span<const T> values, std::size_t width, const Voxel& at, std::uint64_t repeat = 1) {
        const std::uint32_t channel = rows.part.channel;
        rounded_.resize(width * components_of(channel));
        std::ranges::transform(values, rounded_.begin(), [](T value) { return static_cast<float>(value); });
        std::ranges::fill(std::span(rounded_).subspan(values.size()), std::numeric_limits<float>::quiet_NaN());
        if (!(channel & kComparedChannels)) // they may be NaN
            rows.watch.add(std::span(rounded_).first(values.size()), at[1], at[2], repeat, at[0]);
        encode_row(rounded_, rows.part.format, target(rows) + at[0] * rows.part.sample_bytes());
    }
    // The same of facet ids; up to `width` kNoFacet follow.
    void put_ids(PartRows& rows, std::span<const layout::uint> ids, std::size_t width, std::uint64_t from) {
        std::byte* const to = target(rows) + from * sizeof(layout::uint);
        ids_.assign(width, layout::kNoFacet);
        std::ranges::copy(ids, ids_.begin());
        std::memcpy(to, ids_.data(), width * sizeof(layout::uint));
    }
    // The next row of every part is in its place.
    void advance() {
        if (++group_count_ == group_rows_)
            flush_group();
    }
    // The row before stands once more.
    void repeat() {
        for (PartRows& rows : parts_) {
            const std::byte* const previous = group_count_ > 0
                                                  ? target(rows) - row_bytes(rows)
                                                  : rows.handed.data() + rows.handed.size() - row_bytes(rows);
            std::memcpy(target(rows), previous, row_bytes(rows));
        }
        advance();
    }
    // Flushes to disk, reads back and compares, hashes, renames. `place` formats where a watched value stands, as
    // "voxel (1, 2, 3)". Throws as VolumeWriter::finish.
    VolumeResult finish(const PlaceText& place);

    VolumeTimings timings;

private:
    std::size_t row_bytes(const PartRows& rows) const { return width_ * rows.part.sample_bytes(); }
    // Where the part's next row goes.
    std::byte* target(PartRows& rows) { return rows.rows.data() + group_count_ * row_bytes(rows); }
    void flush_group();
    void write_blocks(std::size_t number, std::uint64_t first, std::uint64_t count);
    void write_data(std::span<const std::byte> bytes);
    void write_offsets();
    std::string read_back() const;
    bool refused() const;
    void throw_if_refused(const PlaceText& place) const;

    std::size_t width_, threads_;
    bool in_parallel_; // to whoever brings the rows
    TemporaryFile file_;
    std::vector<PartRows> parts_;
    std::uint64_t group_rows_;
    std::uint64_t group_first_ = 0; // row of the file
    std::uint64_t group_count_ = 0; // rows in the group so far
    std::vector<float> rounded_;    // a row, or a part of one
    std::vector<layout::uint> ids_; // of the facets
    std::vector<exr::BlockPacker::Scratch> scratch_;
    std::vector<std::vector<std::byte>> packed_; // blocks of a part's group
    std::uint64_t data_from_ = 0;                // byte of the file: where blocks begin
    std::uint32_t data_ = 0;                     // CRC-32 of them
    OneBehind group_;                            // the one before, as it is written; ends before what it uses
};

// By a thread of its own while the next group comes, if the file may ask for parallel work. An image that will be
// refused is only watched to its end, so that the message can name its largest value.
void RowsWriter::flush_group() {
    group_.wait();
    check_interrupt();
    for (PartRows& rows : parts_)
        std::swap(rows.rows, rows.handed);
    const auto write = [this, first = group_first_, count = group_count_] {
        for (std::size_t number = 0; number < parts_.size(); ++number)
            write_blocks(number, first, count);
    };
    const bool wanted = !refused() && group_count_ > 0;
    if (wanted && in_parallel_)
        group_.add(write);
    else if (wanted)
        write();
    group_first_ += group_count_;
    group_count_ = 0;
}

// A block of the same rows as the one before, as where a field does not depend on y, has its bytes.
void RowsWriter::write_blocks(std::size_t number, std::uint64_t first, std::uint64_t count) {
    PartRows& rows = parts_[number];
    const std::uint64_t block_rows = rows.packer.rows(), blocks = (count + block_rows - 1) / block_rows;
    const auto rows_of = [&](std::uint64_t block) {
        const std::uint64_t begin = block * block_rows, end = std::min(begin + block_rows, count);
        return std::span(rows.handed).subspan(begin * row_bytes(rows), (end - begin) * row_bytes(rows));
    };
    std::vector<std::uint64_t> own; // blocks that are packed
    std::vector<std::size_t> as;    // of each block: whose bytes it has, an index of own
    for (std::uint64_t block = 0; block < blocks; ++block) {
        const auto is_alike = [&](std::span<const std::byte> one, std::span<const std::byte> other) {
            return one.size() == other.size() && std::memcmp(one.data(), other.data(), one.size()) == 0;
        };
        if (block == 0 || !is_alike(rows_of(block), rows_of(block - 1)))
            own.push_back(block);
        as.push_back(own.size() - 1);
    }
    packed_.resize(std::max(packed_.size(), own.size()));
    share_out(std::min(threads_, own.size()), own.size(), [&](std::size_t thread, std::size_t i) {
        rows.packer.pack(rows_of(own[i]), scratch_[thread], packed_[i]);
    });
    for (std::uint64_t block = 0; block < blocks; ++block) {
        const std::vector<std::byte>& packed = packed_[as[block]];
        rows.offsets.push_back(file_.tell());
        const std::array<std::int32_t, 3> head{static_cast<std::int32_t>(number),
                                               static_cast<std::int32_t>(first + block * block_rows),
                                               static_cast<std::int32_t>(packed.size())};
        write_data(std::as_bytes(std::span(head)).subspan(parts_.size() > 1 ? 0 : sizeof(std::int32_t)));
        write_data(packed);
    }
}

void RowsWriter::write_data(std::span<const std::byte> bytes) {
    data_ = crc32_of(bytes, data_);
    file_.write(bytes);
}

void RowsWriter::write_offsets() {
    std::vector<std::uint64_t> all;
    for (const PartRows& rows : parts_)
        all.insert(all.end(), rows.offsets.begin(), rows.offsets.end());
    file_.seek(data_from_ - all.size() * sizeof(std::uint64_t));
    file_.write(std::as_bytes(std::span(all)));
}

// The SHA-256 of the file. Throws IoError if it does not hold the blocks that were written.
std::string RowsWriter::read_back() const {
    std::uint32_t found = 0;
    std::string sha256 =
        sha256_of_file(file_.temporary_path(), [&](std::span<const std::byte> bytes, std::uint64_t at) {
            if (at + bytes.size() > data_from_)
                found = crc32_of(bytes.subspan(at < data_from_ ? data_from_ - at : 0), found);
        });
    if (found != data_)
        throw IoError("cannot write {}: read back from the disk it differs from what was written; "
                      "check the disk and the memory",
                      file_.path().string());
    return sha256;
}

bool RowsWriter::refused() const {
    for (const PartRows& rows : parts_) {
        if (rows.watch.non_finite() > 0)
            return true;
        if (rows.part.format == PixelFormat::half && overflows_half(static_cast<float>(rows.watch.largest().value)))
            return true;
    }
    return false;
}

void RowsWriter::throw_if_refused(const PlaceText& place) const {
    for (const PartRows& rows : parts_) {
        const auto& [value, at, found] = rows.watch.first_non_finite();
        if (found)
            throw Error(ExitCode::failed,
                        fmt::format("{}: {} is {} at {}: {} values are not finite as floats; no file was written",
                                    file_.path().string(), name_of_channel(rows.part.channel), value, place(at),
                                    rows.watch.non_finite()));
    }
    for (const PartRows& rows : parts_) {
        const auto& [value, at, found] = rows.watch.largest();
        if (rows.part.format == PixelFormat::half && overflows_half(static_cast<float>(value)))
            throw UsageError("{}: half cannot hold {:.6g} {} at {}, its largest is 65504: write pixel = \"float\"",
                             file_.path().string(), static_cast<float>(value), rows.part.unit, place(at));
    }
}

VolumeResult RowsWriter::finish(const PlaceText& place) {
    throw_if_refused(place);
    VolumeResult result;
    timed(timings.encode, [&] {
        flush_group();
        group_.wait();
        write_offsets();
    });
    timed(timings.flush, [&] { file_.flush_to_disk(); });
    // That blocks unpack to what was packed was seen when they were (deflate.cpp).
    timed(timings.read_back, [&] { result.sha256 = read_back(); });
    result.bytes = std::filesystem::file_size(file_.temporary_path());
    timed(timings.flush, [&] { file_.publish(); });
    result.timings = timings;
    const WatchedValue& longest = parts_.front().watch.longest();
    result.largest_force = longest.value;
    result.largest_voxel = longest.voxel;
    return result;
}

Sheet sheet_of(const VolumeHeader& volume) {
    exr::require_possible(volume);
    const auto [nx, ny, nz] = volume.size;
    Sheet sheet{nx, ny * nz, {}, {}, {}, volume.threads};
    const auto vector_of = [](const std::array<double, 3>& v) { return attribute_of(v[0], v[1], v[2]); };
    for (const Part& part : exr::parts_of(volume)) {
        Imf::Header header = make_header(part, nx, ny * nz, volume.compression, volume);
        header.insert("forceshade.grid",
                      Imf::V3iAttribute({static_cast<int>(nx), static_cast<int>(ny), static_cast<int>(nz)}));
        header.insert("forceshade.origin", vector_of(volume.origin));
        header.insert("forceshade.spacing", vector_of(volume.spacing));
        if (volume.channels & layout::kChannelProxy)
            add_place_origin(header, volume.place_origin);
        sheet.add(part, volume.compression, std::move(header));
    }
    return sheet;
}

} // namespace

struct VolumeWriter::State {
    State(const std::filesystem::path& path, const VolumeHeader& volume)
        : rows(path, sheet_of(volume)), order(volume.size) {}

    template <typename real> void write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
        for (std::size_t row = 0; row < chunk.z_count * chunk.y_count; ++row) {
            const Voxel at{0, chunk.y_first + row % chunk.y_count, chunk.z_first + row / chunk.y_count};
            for (PartRows& part : rows.parts()) {
                const std::uint32_t channel = part.part.channel;
                const std::size_t components = components_of(channel);
                const std::size_t first = row * chunk.x_pitch * components, count = chunk.x_count * components;
                if (part.part.format == PixelFormat::id)
                    rows.put_ids(part, ids_of(chunk).subspan(first, count), chunk.x_count, 0);
                else
                    rows.put(part, values_of(chunk, channel).subspan(first, count), chunk.x_count, at, repeat_y);
            }
            rows.advance();
            for (std::size_t copy = 1; copy < repeat_y; ++copy)
                rows.repeat();
        }
    }

    RowsWriter rows;
    RowOrder order;
};

VolumeWriter::VolumeWriter(const std::filesystem::path& path, const VolumeHeader& header)
    : state_(std::make_unique<State>(path, header)) {}
VolumeWriter::~VolumeWriter() = default;

void VolumeWriter::write(const AnyFieldChunk& any, std::size_t repeat_y) {
    timed(state_->rows.timings.encode, [&] {
        state_->order.accept(any, repeat_y);
        std::visit([&](const auto& chunk) { state_->write(chunk, repeat_y); }, any);
    });
}

VolumeResult VolumeWriter::finish() {
    state_->order.require_complete();
    return state_->rows.finish(
        [](const Voxel& voxel) { return fmt::format("voxel ({}, {}, {})", voxel[0], voxel[1], voxel[2]); });
}

namespace {

void require_possible(const PathVolumeHeader& header) {
    if (header.steps == 0 || header.paths == 0)
        throw UsageError("there are no paths to write");
    if (header.steps > kMostColumns)
        throw UsageError(
            "paths of {} steps are longer than the {} that an EXR holds: write a .csv file, or make them shorter",
            header.steps, kMostColumns);
    if (header.paths > kMostRows)
        throw UsageError("{} paths are more than the {} that an EXR holds: write fewer to a file", header.paths,
                         kMostRows);
}

Sheet sheet_of(const PathVolumeHeader& header) {
    require_possible(header);
    Sheet sheet{header.steps, header.paths, {}, {}, {}, header.threads};
    for (const std::uint32_t channel : kPathChannels) {
        if (!(header.channels & channel) && channel != layout::kChannelForce && channel != layout::kChannelPosition)
            continue;
        const bool exact = is_place(channel); // coarser numbers would do to forces; places are read against each other
        const Compression compression =
            exact && header.compression == Compression::pxr24 ? Compression::zip : header.compression;
        const Part part = exr::make_part(channel, exact ? PixelType::float32 : header.pixel, compression);
        Imf::Header image = make_header(part, header.steps, header.paths, compression, header);
        image.insert("forceshade.paths",
                     Imf::V2iAttribute({static_cast<int>(header.steps), static_cast<int>(header.paths)}));
        if (header.rate > 0)
            image.insert("forceshade.rate", Imf::DoubleAttribute(header.rate));
        add_place_origin(image, header.place_origin);
        sheet.add(part, compression, std::move(image));
    }
    return sheet;
}

} // namespace

struct PathVolumeWriter::State {
    State(const std::filesystem::path& path, const PathVolumeHeader& from) : header(from), rows(path, sheet_of(from)) {}

    template <typename T> void write(const PathRows<T>& paths) {
        if (paths.path_first != next || paths.step_first != step || paths.step_first + paths.pitch > header.steps ||
            next + paths.path_count > header.paths)
            throw std::logic_error(fmt::format("step {} of path {} is not what follows step {} of {}", paths.step_first,
                                               paths.path_first, step, next));
        for (std::size_t path = 0; path < paths.path_count; ++path) {
            // The samples, and where the path ends with them what fills its row up.
            const std::size_t first = path * paths.pitch, samples = paths.samples(path);
            const std::size_t width = paths.ends(path) ? header.steps - paths.step_first : samples;
            for (PartRows& part : rows.parts()) {
                const std::size_t components = components_of(part.part.channel);
                if (part.part.format == PixelFormat::id)
                    rows.put_ids(part, paths.facet.subspan(first, samples), width, paths.step_first);
                else
                    rows.put(part,
                             values_of(paths, part.part.channel).subspan(first * components, samples * components),
                             width, {paths.step_first, paths.path_first + path, 0});
            }
            step = paths.step_first + paths.pitch;
            if (!paths.ends(path))
                continue;
            rows.advance();
            step = 0;
            ++next;
        }
    }

    PathVolumeHeader header;
    RowsWriter rows;
    std::uint64_t next = 0; // path
    std::uint64_t step = 0; // of it, the next
};

PathVolumeWriter::PathVolumeWriter(const std::filesystem::path& path, const PathVolumeHeader& header)
    : state_(std::make_unique<State>(path, header)) {}
PathVolumeWriter::~PathVolumeWriter() = default;

void PathVolumeWriter::write(const AnyPathRows& any) {
    timed(state_->rows.timings.encode, [&] { std::visit([&](const auto& rows) { state_->write(rows); }, any); });
}

VolumeResult PathVolumeWriter::finish() {
    if (state_->next != state_->header.paths)
        throw std::logic_error(fmt::format("only {} of {} paths were written", state_->next, state_->header.paths));
    return state_->rows.finish([](const Voxel& at) { return fmt::format("step {} of path {}", at[0], at[1]); });
}

} // namespace forceshade
