// Comma-separated values as RFC 4180 quotes them, read a record at a time from a file of any length.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <glm/vec3.hpp>

#include "host/output/files.h"
#include "host/scene/value.h"

namespace forceshade {

/// Lines end in LF or CRLF; empty lines and a UTF-8 byte order mark are skipped; blanks round a cell do not belong to
/// it. A cell may be quoted, and hold commas and line breaks then. Memory does not grow with the file.
class CsvReader {
public:
    /// \throws IoError if the file cannot be read, UsageError `file:line:column: ...` if it is UTF-16.
    explicit CsvReader(const std::filesystem::path& path);
    /// Of a file that was read before, with all that was in it.
    CsvReader(const std::filesystem::path& path, std::string_view content);

    /// Goes on to the next record; false at the end of the file. \throws UsageError for a quote that does not end, a
    /// lone carriage return, or a record beyond 1 MiB.
    bool next();

    /// Of the present record: how many cells, what they hold, where they begin. Valid until the next record.
    std::size_t size() const noexcept { return cells_.size(); }
    std::string_view text(std::size_t cell) const;
    Location where(std::size_t cell) const { return cells_[cell].where; }
    /// Where the record ends.
    Location end() const noexcept { return end_; }

    /// True once the file has ended without a line feed after its last record.
    bool ends_open() const noexcept { return ends_open_; }

    const std::string& source() const noexcept { return source_; }
    /// Not of a file that was read before.
    const ReadableFile& file() const noexcept { return *file_; }
    std::uint64_t bytes() const noexcept { return file_->size(); } /* in all */
    std::uint64_t bytes_read() const noexcept { return offset_ - (filled_ - next_); }

private:
    struct Cell {
        std::size_t begin, end; /* in text_ */
        Location where;
    };
    static constexpr int kEnd = -1;

    int peek();
    void take();
    void begin();
    void refill();
    void read_record();
    void read_cell();
    void read_plain();
    void read_quoted();
    void skip_blanks();
    bool take_line_end();

    std::optional<ReadableFile> file_; // none: all is in the buffer
    std::string source_;
    std::vector<std::byte> buffer_;
    std::uint64_t offset_ = 0;          /* bytes of the file that have been in the buffer */
    std::size_t next_ = 0, filled_ = 0; /* in buffer_ */
    Location here_{1, 1}, begin_, end_;
    std::size_t record_bytes_ = 0;
    std::string text_; // of the record's cells, without quotes
    std::vector<Cell> cells_;
    bool ends_open_ = false;
};

// Recorded exploration paths: a CSV file with columns path, t, x, y and z, read a few samples at a time.

struct PathSample {
    std::uint64_t path; // samples with the same number form a path, in the order of the file
    double time;        /* s */
    glm::dvec3 probe;   /* m */
    std::uint32_t line; // of the file, for errors
};

/// Columns may stand in any order, and others among them are not read; without one of paths' numbers all samples are
/// of path 0. Every number must be finite.
class PathReader {
public:
    /// Reads the header. `largest_coordinate`, m: positions beyond it are refused.
    /// \throws IoError if the file cannot be read, UsageError `file:line:column: ...` for a header that lacks a column
    /// or has one twice.
    PathReader(const std::filesystem::path& path, double largest_coordinate);

    /// Replaces `samples` by the next ones, `most` or what is left; empty at the end of the file.
    /// \throws UsageError `file:line:column: x: ...` for the first row that is not a sample, or without any row.
    void read(std::vector<PathSample>& samples, std::size_t most);

    const CsvReader& csv() const noexcept { return csv_; }

private:
    enum Column : std::size_t { kPath, kTime, kX, kY, kZ, kColumns };
    static constexpr std::size_t kNone = std::size_t(-1);

    void read_header();
    bool is_path_meant() const;
    void refuse_header() const;
    void check_width() const;
    double number(Column column) const;
    double coordinate(Column column) const;
    std::uint64_t path_id() const;
    [[noreturn]] void refuse(Column column, const std::string& message) const;

    CsvReader csv_;
    double largest_coordinate_;                 /* m */
    std::array<std::size_t, kColumns> cells_{}; // where in a row each column stands; kNone: a file of one path
    std::size_t width_ = 0;                     // cells of a row
    bool any_ = false;
};

// How far places of paths are from an origin, and from one sample to the next.

class StepScale {
public:
    /// `origin`: m, in the world.
    explicit StepScale(const glm::dvec3& origin = glm::dvec3(0)) : origin_(origin) {}

    /// A path's first place, m, in the world.
    void begin(const glm::dvec3& place);
    /// A further one, and the one before it.
    void add(const glm::dvec3& place, const glm::dvec3& before);

    /// The largest coordinate from the origin, m.
    double farthest() const { return farthest_; }
    /// The median distance from one sample to the next where there is any, m, to a factor of 1.2; 0 where there is
    /// none.
    double median_step() const;

private:
    static constexpr int kLeast = -1100; // exponents of a square
    static constexpr std::size_t kExponents = 2200;

    glm::dvec3 origin_; /* m */
    double farthest_ = 0;
    std::array<std::uint64_t, kExponents> steps_{}; // by the exponent of the square of their length
};

// The paths of a recorded file as its samples come by: which path a sample belongs to, and whether it may follow.

class PathCensus {
public:
    /// `source`: the file's name, for errors. `period`, s: what the times of a path keep to within 1 %; 0: they need
    /// only increase. `origin`: as for StepScale.
    explicit PathCensus(std::string source, double period = 0, const glm::dvec3& origin = glm::dvec3(0))
        : source_(std::move(source)), period_(period), scale_(origin) {}

    /// Paths are numbered by their first samples: the number of the sample's.
    /// \throws UsageError `file:line:column: t: ...` if its time does not come after that of its path's sample before,
    /// or not by a period.
    std::size_t add(const PathSample& sample);

    /// The file's own numbers of the paths.
    const std::vector<std::uint64_t>& ids() const { return ids_; }
    std::size_t paths() const { return ids_.size(); }
    /// The line at which a path first goes on after samples of another.
    std::optional<std::uint32_t> first_return() const { return first_return_; }
    const StepScale& scale() const { return scale_; }

private:
    void check_time(const PathSample& sample, double before) const;

    std::string source_;
    double period_; /* s */
    std::unordered_map<std::uint64_t, std::size_t> numbers_;
    std::vector<std::uint64_t> ids_;
    std::vector<double> times_;      /* s: of each path's last sample */
    std::vector<glm::dvec3> places_; /* m: of the same */
    StepScale scale_;
    std::size_t last_ = 0; // the path of the sample before
    std::optional<std::uint32_t> first_return_;
};

} // namespace forceshade
