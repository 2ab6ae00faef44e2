// Recorded exploration paths: a CSV file with columns path, t, x, y and z, read a few samples at a time.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <vector>

#include <glm/vec3.hpp>

#include "host/explore/csv_reader.h"

namespace forceshade {

struct PathSample {
    std::uint64_t path; // samples with the same number form a path, in the order of the file
    double time;        /* s */
    glm::dvec3 probe;   /* m */
    std::uint32_t line; // of the file, for errors
};

/// Columns may stand in any order, and others among them are not read. Every number must be finite.
class PathReader {
public:
    /// Reads the header. `largest_coordinate`, m: positions beyond it are refused.
    /// \throws IoError if the file cannot be read, UsageError `file:line:column: ...` for a header that lacks a column
    /// or has one twice.
    PathReader(const std::filesystem::path& path, double largest_coordinate);

    /// Replaces `samples` by the next ones, `most` or what is left; empty at the end of the file.
    /// \throws UsageError `file:line:column: x: ...` for the first row that is no sample, or if there is none at all.
    void read(std::vector<PathSample>& samples, std::size_t most);

    const CsvReader& csv() const noexcept { return csv_; }

private:
    enum Column : std::size_t { kPath, kTime, kX, kY, kZ, kColumns };

    void read_header();
    void refuse_header() const;
    void check_width() const;
    double number(Column column) const;
    double coordinate(Column column) const;
    std::uint64_t path_id() const;
    [[noreturn]] void refuse(Column column, const std::string& message) const;

    CsvReader csv_;
    double largest_coordinate_;                 /* m */
    std::array<std::size_t, kColumns> cells_{}; // where in a row each column stands
    std::size_t width_ = 0;                     // cells of a row
    bool any_ = false;
};

} // namespace forceshade
