// The rows of an image of several parts on their way to OpenEXR, group by group, and read back before the file gets its
// name; only for .cpp files that use OpenEXR.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include <ImfMultiPartOutputFile.h>
#include <ImfOutputPart.h>

#include "host/io/chunk_sink.h"
#include "host/io/exr_parts.h"
#include "host/io/exr_stream.h"
#include "host/io/hash.h"
#include "host/io/temporary_file.h"

namespace forceshade::exr {

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
