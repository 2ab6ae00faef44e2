// The readers of the formats, each from the whole file in memory.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh_file.h"

namespace forceshade::mesh_file {

/// A file that has been read: its name for messages, its bytes, and whether to read its vertex normals.
struct Source {
    std::string name;
    std::string_view bytes;
    bool normals = false;
};

/// All but the SHA-256.
PolygonFile read_obj(const Source& source);
PolygonFile read_off(const Source& source);
PolygonFile read_ply(const Source& source);
PolygonFile read_stl(const Source& source);

/// True if no zero byte is among the first: text has none, and triangles do.
bool looks_like_text(std::string_view bytes);

/// How many bytes are behind the triangles that a binary STL file announces. None if the triangles are not all there,
/// or if none are announced and yet bytes follow.
std::optional<std::size_t> bytes_behind_binary_stl(std::string_view bytes);

/// The keyword of an OFF file: "COFF8" has the prefix "C" and the count "8", which some programs write without a blank.
struct OffKeyword {
    std::string_view prefix, count;
};

/// Empty if the word is not such a keyword.
std::optional<OffKeyword> parse_off_keyword(std::string_view word);

/// Elements of a file that a reader skips, counted by kind.
class Skipped {
public:
    struct Kind {
        std::string_view one, several; // "face of two corners", "faces of two corners"
    };

    /// `where`: what stands before a place, "in line" or "at byte".
    explicit Skipped(std::string_view where) : where_(where) {}

    void add(const Kind& kind, std::size_t place);

    bool empty() const { return entries_.empty(); }

    /// "3 faces of two corners: skipped (the first in line 12)", a sentence for each kind.
    std::vector<std::string> warnings() const;

private:
    struct Entry {
        Kind kind;
        std::size_t count, first;
    };
    std::string_view where_;
    std::vector<Entry> entries_;
};

/// Of 0, 1 and 2 corners.
inline constexpr std::array<Skipped::Kind, 3> kShortFaces{{{"face without corners", "faces without corners"},
                                                           {"face of one corner", "faces of one corner"},
                                                           {"face of two corners", "faces of two corners"}}};
inline constexpr Skipped::Kind kTextLine{"line of text", "lines of text"};

/// True if the words are the same but for capitals; `keyword` has none.
bool is_keyword(std::string_view word, std::string_view keyword);

/// An integer of up to 8 bytes.
std::uint64_t read_bits(const char* bytes, std::size_t size, bool big_endian = false);

// Text files read line by line and word by word, in no locale, with errors that name file and line.

/// The lines of a text, ended by LF, CR LF or CR; a byte order mark at the beginning of a line is skipped.
class TextLines {
public:
    /// `number`: of the line before the text.
    TextLines(std::string file, std::string_view text, std::size_t number = 0);

    /// The next line without its end, or false.
    bool next(std::string_view& line);

    /// The next line that has words once a comment (from `#` on) is cut off, or false.
    bool next_words(std::string_view& line);

    std::size_t line_number() const noexcept { return number_; } /* of the line last read, from 1 */
    std::string_view rest() const noexcept { return text_; }
    bool line_has_end() const noexcept { return has_end_; } /* false: the file ends in the line last read */

    /// Throws IoError: `bump.off:12: message`.
    template <typename... Parts>
    [[noreturn]] void damaged(fmt::format_string<Parts...> message, Parts&&... parts) const {
        damaged_at(number_, message, std::forward<Parts>(parts)...);
    }
    template <typename... Parts>
    [[noreturn]] void damaged_at(std::size_t line, fmt::format_string<Parts...> message, Parts&&... parts) const {
        throw IoError("{}:{}: {}", file_, line, fmt::format(message, std::forward<Parts>(parts)...));
    }

private:
    std::string file_;
    std::string_view text_;
    std::size_t number_;
    bool has_end_ = true;
};

/// Takes the next word (up to a space or a tab) off the front of a line; empty at its end.
std::string_view take_word(std::string_view& line);

/// A block of a text file, of whole lines.
struct TextBlock {
    std::string_view text;
    bool is_first, is_last;
    std::size_t lines_before = 0, lines = 0; /* with words, before it and in it; if they are counted */
};

/// Reads a large text by blocks that begin with a line of this keyword, or with any line, on all threads. None where
/// the text is small, or `read` throws or returns none for a block that cannot be read alone, or a corner is no vertex:
/// then it is to be read as a whole, which says what is wrong in which line.
/// \param read of a block; any thread may call it
std::optional<PolygonSoup>
read_in_blocks(std::string_view text, std::string_view keyword, bool counts_lines,
               const std::function<std::optional<PolygonSoup>(const TextBlock& block)>& read);

/// A word for a message: in quotes, shortened, without control characters.
std::string in_quotes(std::string_view word);

/// True if the whole word is a number. Values beyond a double's range become infinite or 0, "nan" and "inf" are read.
bool parse_number(std::string_view word, double& value);

/// True if the whole word is an integer of 64 bits.
bool parse_integer(std::string_view word, std::int64_t& value);

/// True if a line has words and each of them is a number or an OBJ corner such as 7/1/3: it may be a damaged vertex or
/// facet, and is not text.
bool has_only_numbers(std::string_view line);

/// Three numbers that next_word() gives; whose() ends the message about a word that is none.
template <typename Whose, typename NextWord>
glm::dvec3 read_coordinates(const TextLines& lines, const Whose& whose, const NextWord& next_word) {
    glm::dvec3 vertex;
    for (int axis = 0; axis < 3; ++axis)
        if (const std::string_view word = next_word(); !parse_number(word, vertex[axis]))
            lines.damaged("{} is not a coordinate{}", in_quotes(word), whose());
    return vertex;
}

} // namespace forceshade::mesh_file
