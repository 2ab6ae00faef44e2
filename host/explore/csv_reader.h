// Comma-separated values as RFC 4180 quotes them, read a record at a time from a file of any length.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "host/io/readable_file.h"
#include "host/scene/location.h"

namespace forceshade {

/// Lines end in LF or CRLF; empty lines and a UTF-8 byte order mark are skipped; blanks round a cell do not belong to
/// it. A cell may be quoted, and hold commas and line breaks then. Memory does not grow with the file.
class CsvReader {
public:
    /// \throws IoError if the file cannot be read, UsageError `file:line:column: ...` if it is UTF-16.
    explicit CsvReader(const std::filesystem::path& path);

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
    const ReadableFile& file() const noexcept { return file_; }
    std::uint64_t bytes() const noexcept { return file_.size(); } /* in all */
    std::uint64_t bytes_read() const noexcept { return offset_ - (filled_ - next_); }

private:
    struct Cell {
        std::size_t begin, end; /* in text_ */
        Location where;
    };
    static constexpr int kEnd = -1;

    int peek();
    void take();
    void refill();
    void read_record();
    void read_cell();
    void read_plain();
    void read_quoted();
    void skip_blanks();
    bool take_line_end();

    ReadableFile file_;
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

} // namespace forceshade
