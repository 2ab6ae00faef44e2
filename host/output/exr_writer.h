// How a volume is laid out in an EXR's parts; only for the .cpp files of the volumes.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>

#include "host/output/exr_image.h"
#include "host/output/exr_volume.h"
#include "host/output/files.h"
#include "host/output/rows.h"

namespace forceshade::exr {

/// One part of a volume; its rows in memory are tight, samples interleaved by component.
struct Part {
    std::uint32_t channel = 0;         /* layout::kChannel... */
    std::vector<const char*> channels; /* names in the file, by component */
    const char* unit = "";             /* of the samples */
    PixelFormat format = PixelFormat::float32;

    std::size_t sample_bytes() const { return channels.size() * bytes_of(format); }
};

/// Of the channel its names in the file and its unit; how its values stand there follows from the rest.
Part make_part(std::uint32_t channel, PixelType pixel, Compression compression);

/// The parts of a volume in file order.
std::vector<Part> parts_of(const VolumeHeader& header);

/// Throws UsageError if no EXR can hold such a grid.
void require_possible(const VolumeHeader& header);

/// The part's header: nothing in it depends on the day or the machine.
Imf::Header make_header(const Part& part, const VolumeHeader& volume);

/// Describes `count` rows at `bytes`, the first of which is row `first`; pixel type as in the file.
Imf::FrameBuffer frame_of(const Part& part, std::uint64_t width, std::uint64_t first, std::uint64_t count,
                          const std::byte* bytes);

/// Rows that are handed to OpenEXR at once: a multiple of every compression's block, about 4 MiB of force.
/// It decides how the parts' blocks interleave in the file, so it may depend on nothing but the image's size.
std::uint64_t rows_per_group(std::uint64_t width, std::uint64_t rows);

/// What is inserted into a header alike for volumes and for paths.
void insert_text(Imf::Header& header, const Part& part, const std::string& scene, const std::string& version,
                 const std::string& omitted);
/// An empty image of the part: its name, channels and compression.
Imf::Header make_image_header(const Part& part, std::uint64_t width, std::uint64_t rows, Compression compression);

/// Sees to it that OpenEXR's workers, which all files share, are at least `threads`.
void require_workers(int threads);

/// An image of several parts, ready to be written.
struct Sheet {
    std::uint64_t width = 0, rows = 0;
    std::vector<Part> parts;
    std::vector<Imf::Header> headers; /* of the parts */
    int threads = 0;                  /* that compress this file; 0: it asks for no parallel work */
};

/// The checksum of the decoded pixels of each part, in file order, read from `file`. Throws IoError naming `path`.
std::vector<std::uint64_t> checksums_of(const std::filesystem::path& file, const std::filesystem::path& path,
                                        const Sheet& sheet);

// The rows of an image of several parts on their way to OpenEXR, group by group, and read back before the file gets its
// name; only for .cpp files that use OpenEXR.

/// Adds the time until its end to a sum, s.
class Stopwatch {
public:
    explicit Stopwatch(double& sum);
    ~Stopwatch();

private:
    double& sum_;
    double start_;
};

/// The rows of one part on their way to OpenEXR.
struct PartRows {
    PartRows(const Part& part_, std::size_t bytes);

    Part part;
    std::vector<std::byte> rows; // a group
    PixelWatch watch;
    PixelChecksum checksum;
    std::optional<Imf::OutputPart> output;
};

/// Memory is a group of rows a part. The bytes of the file depend on the sheet and the rows alone.
class RowsWriter {
public:
    /// Throws IoError.
    RowsWriter(const std::filesystem::path& path, Sheet sheet, bool allow_non_finite);

    std::vector<PartRows>& parts() noexcept { return parts_; }
    /// Where the part's next row goes: width * sample_bytes.
    std::byte* target(PartRows& rows) { return rows.rows.data() + group_count_ * row_bytes(rows); }
    /// The next row of every part is in its place.
    void advance();
    /// The row before stands once more.
    void repeat();
    /// Flushes to disk, reads back and compares, hashes, renames. `place` tells where a watched value stands, as "voxel
    /// (1, 2, 3)". Throws as VolumeWriter::finish.
    VolumeResult finish(const std::function<std::string(const Voxel&)>& place);

    VolumeTimings timings;

private:
    std::size_t row_bytes(const PartRows& rows) const { return sheet_.width * rows.part.sample_bytes(); }
    void flush_group();
    void close();
    bool refused() const;
    void throw_if_refused(const std::function<std::string(const Voxel&)>& place) const;
    void read_back();

    Sheet sheet_;
    bool allow_non_finite_;
    TemporaryFile file_;
    WriteStream stream_;
    std::unique_ptr<Imf::MultiPartOutputFile> output_; // before the parts: they refer to it
    std::vector<PartRows> parts_;
    std::uint64_t group_rows_;
    std::uint64_t group_first_ = 0; // row of the file
    std::uint64_t group_count_ = 0; // rows in the group so far
};

} // namespace forceshade::exr
