// Recorded strokes and the forces of renderers along them, as files of many kinds have them.
#pragma once

#include <cmath>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include <glm/vec3.hpp>

#include "host/reference/elementary.h"

namespace forceshade::score {

// A table of numbers in a file: CSV with a header, rows of numbers without one, or a NumPy array.

struct NumberTable {
    std::string source;                     /* the file's name, for errors */
    std::vector<std::string> columns;       /* as the header has them; without one "#1", "#2", ... */
    std::vector<std::vector<double>> cells; /* a vector a column; NaN where a cell is empty or no number */
    std::vector<std::uint32_t> lines;       /* of the rows, for errors; of an array the rows' numbers from 0 */
    bool named = false;                     /* a header names the columns */
    std::vector<std::string> words; /* of each column the first cell that is no number, "7: \"abc\""; or empty */

    std::size_t rows() const { return lines.size(); }
};

/// A file that ends in .npy is an array of f4 or f8, of rows of columns. Another is text: numbers between commas; with
/// tabs or semicolons in its first row between those, where decimal commas are read, too; else between blanks. Lines
/// that begin with # are comments; the last one before the first row is the header if it names as many columns. \throws
/// IoError, UsageError `file:line: ...` for rows of different lengths, or no row at all.
NumberTable read_numbers(const std::filesystem::path& file);

// Which column is what.

/// Of the quantities path, t, x, y, z, fx, fy, fz: the column that has it, its sign, and its unit.
struct ColumnSource {
    std::string column;
    bool negative = false;
    std::optional<double> unit; /* SI units in one of the column's; none: as its name says, else 1 */
    mutable bool found = false; /* some file had the column */
};
using ColumnMap = std::map<std::string, ColumnSource, std::less<>>;

/// "x=px mm, y=-pz mm, fx='force x', t=#1 ms": QUANTITY=[-]COLUMN[ UNIT], separated by commas; a name with blanks
/// stands in quotes. \throws UsageError.
ColumnMap parse_map(const std::string& text);

/// \throws UsageError for a column that none of the files read so far has.
void require_found(const ColumnMap& map);

// Strokes.

struct Stroke {
    std::uint64_t id = 0;
    std::string scene{};              // of a course; else empty
    std::vector<double> time;         /* s */
    std::vector<glm::dvec3> probe;    /* m */
    std::vector<std::uint32_t> lines; /* of its source, for errors */
    std::vector<std::uint32_t> rows;  /* the same without headers and comments, from 0 */
};

struct Strokes {
    std::string source;
    std::vector<Stroke> all;
    std::optional<double> period; /* s: from sample to sample of every stroke, to 1 %; none: it varies */
    std::vector<std::string> warnings;

    std::size_t samples() const;
};

using reference::is_finite;

/// Forces along strokes: one a sample, N, perhaps not finite.
using Track = std::vector<std::vector<glm::dvec3>>;

/// Columns by the map, else by their own names: x, y, z, and perhaps path and t; a unit in the name counts
/// ("x_mm", "t [ms]"). Without times, `rate`, Hz, gives them. `size`, m: of the scene, against which positions are
/// held: a file in another unit is refused, not taken. \throws IoError, UsageError.
Strokes read_strokes(const std::filesystem::path& file, const ColumnMap& map, std::optional<double> rate, double size);

/// \throws UsageError with the remedy for positions, m, that reach much further than a scene of this size, m.
void check_reach(const std::string& source, const std::vector<glm::dvec3>& places, double size,
                 const std::string& remedy);

/// The forces fx, fy, fz of a renderer along strokes: of the same samples in the same order. Where the file has
/// positions, they must be the strokes'. \throws IoError, UsageError `file:line: ...`.
Track read_forces(const std::filesystem::path& file, const ColumnMap& map, const Strokes& strokes);

} // namespace forceshade::score
