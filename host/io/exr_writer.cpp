#include <cassert>
#include <chrono>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <utility>

#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>
#include <fmt/core.h>

#include "host/error.h"
#include "host/io/chunk_rows.h"
#include "host/io/exr_parts.h"
#include "host/io/exr_stream.h"
#include "host/io/exr_volume.h"
#include "host/io/hash.h"
#include "host/io/pixel_rows.h"
#include "host/io/temporary_file.h"

namespace forceshade {
namespace {

/// Adds the time until its end to a sum.
class Stopwatch {
public:
    explicit Stopwatch(double& sum) : sum_(sum), start_(std::chrono::steady_clock::now()) {}
    ~Stopwatch() { sum_ += std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

private:
    double& sum_;
    std::chrono::steady_clock::time_point start_;
};

/// The rows of one part on their way to OpenEXR.
struct PartRows {
    PartRows(const exr::Part& part_, std::size_t bytes)
        : part(part_), rows(bytes), watch(components_of(part.channel)) {}

    exr::Part part;
    std::vector<std::byte> rows; // a group
    PixelWatch watch;
    PixelChecksum checksum;
    std::optional<Imf::OutputPart> output;
};

} // namespace

struct VolumeWriter::State {
    State(const std::filesystem::path& path, const VolumeHeader& volume);

    template <typename real> void write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y);
    VolumeResult finish();

private:
    template <typename real>
    void convert_row(const layout::FieldChunk<real>& chunk, std::size_t row, std::size_t repeat, PartRows& rows);
    void advance();
    void flush_group();
    void close();
    bool refused() const;
    void throw_if_refused() const;
    void read_back();
    std::size_t row_bytes(const PartRows& rows) const { return header.size[0] * rows.part.sample_bytes(); }

    VolumeHeader header;
    TemporaryFile file;
    exr::WriteStream stream;
    RowOrder order;
    std::unique_ptr<Imf::MultiPartOutputFile> output; // before the parts: they refer to it
    std::vector<PartRows> parts;
    std::vector<float> rounded; // one row of doubles, as floats
    std::uint64_t group_rows;
    std::uint64_t group_first = 0; // row of the file
    std::uint64_t group_count = 0; // rows in the group so far
    VolumeTimings timings;
};

VolumeWriter::State::State(const std::filesystem::path& path, const VolumeHeader& volume)
    : header((exr::require_possible(volume), volume)), file(path), stream(file), order(volume.size),
      group_rows(exr::rows_per_group(volume)) {
    exr::require_workers(header.threads);
    std::vector<Imf::Header> headers;
    for (const exr::Part& part : exr::parts_of(header)) {
        parts.emplace_back(part, group_rows * header.size[0] * part.sample_bytes());
        headers.push_back(exr::make_header(part, header));
    }
    exr::guarded(stream, "write", path, [&] {
        output = std::make_unique<Imf::MultiPartOutputFile>(stream, headers.data(), static_cast<int>(headers.size()),
                                                            false, header.threads);
        for (std::size_t i = 0; i < parts.size(); ++i)
            parts[i].output.emplace(*output, static_cast<int>(i));
    });
}

template <typename real> void VolumeWriter::State::write(const layout::FieldChunk<real>& chunk, std::size_t repeat_y) {
    const Stopwatch stopwatch(timings.encode);
    order.accept(chunk, repeat_y);
    for (std::size_t row = 0; row < chunk.z_count * chunk.y_count; ++row) {
        for (PartRows& rows : parts)
            convert_row(chunk, row, repeat_y, rows);
        advance();
        for (std::size_t copy = 1; copy < repeat_y; ++copy) {
            const std::uint64_t previous = (group_count + group_rows - 1) % group_rows; // a full group stays in memory
            for (PartRows& rows : parts)
                std::memmove(rows.rows.data() + group_count * row_bytes(rows),
                             rows.rows.data() + previous * row_bytes(rows), row_bytes(rows));
            advance();
        }
    }
}

template <typename real>
void VolumeWriter::State::convert_row(const layout::FieldChunk<real>& chunk, std::size_t row, std::size_t repeat,
                                      PartRows& rows) {
    std::byte* target = rows.rows.data() + group_count * row_bytes(rows);
    const std::size_t components = components_of(rows.part.channel);
    const std::size_t first = row * chunk.x_pitch * components, count = chunk.x_count * components;
    if (rows.part.format == PixelFormat::id) {
        std::memcpy(target, ids_of(chunk).subspan(first, count).data(), count * sizeof(layout::uint));
        return;
    }
    const std::span<const real> values = values_of(chunk, rows.part.channel).subspan(first, count);
    std::span<const float> floats;
    if constexpr (std::is_same_v<real, float>) {
        floats = values;
    } else {
        rounded.resize(count);
        for (std::size_t i = 0; i < count; ++i)
            rounded[i] = static_cast<float>(values[i]);
        floats = rounded;
    }
    rows.watch.add(floats, chunk.y_first + row % chunk.y_count, chunk.z_first + row / chunk.y_count, repeat);
    encode_row(floats, rows.part.format, target);
}

void VolumeWriter::State::advance() {
    if (++group_count == group_rows)
        flush_group();
}

// A volume that will be refused is only watched to its end, so that the message can name its largest value.
void VolumeWriter::State::flush_group() {
    for (PartRows& rows : parts) {
        if (refused() || group_count == 0)
            break;
        rows.checksum.update(std::span(rows.rows).first(group_count * row_bytes(rows)));
        exr::guarded(stream, "write", file.path(), [&] {
            rows.output->setFrameBuffer(
                exr::frame_of(rows.part, header.size[0], group_first, group_count, rows.rows.data()));
            rows.output->writePixels(static_cast<int>(group_count));
        });
    }
    group_first += group_count;
    group_count = 0;
}

bool VolumeWriter::State::refused() const {
    for (const PartRows& rows : parts) {
        if (rows.watch.non_finite() > 0 && !header.allow_non_finite)
            return true;
        if (rows.part.format == PixelFormat::half && overflows_half(static_cast<float>(rows.watch.largest().value)))
            return true;
    }
    return false;
}

void VolumeWriter::State::throw_if_refused() const {
    for (const PartRows& rows : parts) {
        const auto& [value, voxel, found] = rows.watch.first_non_finite();
        if (found && !header.allow_non_finite)
            throw Error(ExitCode::failed, fmt::format("{}: {} is {} at voxel ({}, {}, {}): {} values are not finite as "
                                                      "floats; nothing was written",
                                                      file.path().string(), name_of_channel(rows.part.channel), value,
                                                      voxel[0], voxel[1], voxel[2], rows.watch.non_finite()));
    }
    for (const PartRows& rows : parts) {
        const auto& [value, voxel, found] = rows.watch.largest();
        if (rows.part.format == PixelFormat::half && overflows_half(static_cast<float>(value)))
            throw UsageError(fmt::format(
                "{}: half cannot hold {:.6g} {} at voxel ({}, {}, {}), its largest is 65504: write "
                "pixel = \"float\"",
                file.path().string(), static_cast<float>(value), rows.part.unit, voxel[0], voxel[1], voxel[2]));
    }
}

// OpenEXR writes the blocks' offsets from destructors, which swallow what goes wrong; but after a failure the file
// cannot be flushed or published any more.
void VolumeWriter::State::close() {
    flush_group();
    for (PartRows& rows : parts)
        rows.output.reset();
    output.reset();
}

void VolumeWriter::State::read_back() {
    const std::vector<std::uint64_t> found = exr::checksums_of(file.temporary_path(), file.path(), header);
    for (std::size_t i = 0; i < parts.size(); ++i)
        if (found.size() != parts.size() || found[i] != parts[i].checksum.value())
            throw IoError(fmt::format("cannot write {}: read back from the disk, the part {} differs from what was "
                                      "written; check the disk and the memory",
                                      file.path().string(), name_of_channel(parts[i].part.channel)));
}

VolumeResult VolumeWriter::State::finish() {
    order.require_complete();
    throw_if_refused();
    VolumeResult result;
    {
        const Stopwatch stopwatch(timings.encode);
        close();
    }
    {
        const Stopwatch stopwatch(timings.flush);
        file.flush_to_disk();
    }
    {
        const Stopwatch stopwatch(timings.read_back);
        read_back();
    }
    {
        const Stopwatch stopwatch(timings.hash);
        result.sha256 = sha256_of_file(file.temporary_path());
        result.bytes = std::filesystem::file_size(file.temporary_path());
    }
    {
        const Stopwatch stopwatch(timings.flush);
        file.publish();
    }
    result.timings = timings;
    const WatchedValue& longest = parts.front().watch.longest();
    result.largest_force = longest.value;
    result.largest_voxel = longest.voxel;
    for (const PartRows& rows : parts)
        result.non_finite += rows.watch.non_finite();
    return result;
}

VolumeWriter::VolumeWriter(const std::filesystem::path& path, const VolumeHeader& header)
    : state_(std::make_unique<State>(path, header)) {}
VolumeWriter::~VolumeWriter() = default;

void VolumeWriter::write(const layout::FieldChunk<float>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}

void VolumeWriter::write(const layout::FieldChunk<double>& chunk, std::size_t repeat_y) {
    state_->write(chunk, repeat_y);
}

VolumeResult VolumeWriter::finish() {
    return state_->finish();
}

} // namespace forceshade
