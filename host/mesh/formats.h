// The readers of the formats, each from the whole file in memory.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/mesh_file.h"

namespace forceshade::mesh_file {

/// A file that has been read: its name for messages, its bytes, and whether its vertex normals are wanted.
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

/// True if the bytes have exactly the length that a binary STL file announces.
bool is_binary_stl(std::string_view bytes);

/// True if the words are the same but for capitals; `keyword` has none.
bool is_keyword(std::string_view word, std::string_view keyword);

/// An integer of up to 8 bytes.
std::uint64_t read_bits(const char* bytes, std::size_t size, bool big_endian = false);

// Text files read line by line and word by word, in no locale, with errors that name file and line.

/// The lines of a text, ended by LF, CR LF or CR; a byte order mark is skipped.
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

    /// Throws IoError: `bump.off:12: message`.
    template <typename... Parts>
    [[noreturn]] void damaged(fmt::format_string<Parts...> message, Parts&&... parts) const {
        throw IoError(fmt::format("{}:{}: {}", file_, number_, fmt::format(message, std::forward<Parts>(parts)...)));
    }

private:
    std::string file_;
    std::string_view text_;
    std::size_t number_;
};

/// Takes the next word (up to a space or a tab) off the front of a line; empty at its end.
std::string_view take_word(std::string_view& line);

/// A word for a message: in quotes, shortened, without control characters.
std::string in_quotes(std::string_view word);

/// True if the whole word is a number. Values beyond a double's range become infinite or 0, "nan" and "inf" are read.
bool parse_number(std::string_view word, double& value);

/// True if the whole word is an integer of 64 bits.
bool parse_integer(std::string_view word, std::int64_t& value);

/// Three numbers that next_word() gives; `whose` ends the message about a word that is none.
template <typename NextWord>
glm::dvec3 read_coordinates(const TextLines& lines, const std::string& whose, const NextWord& next_word) {
    glm::dvec3 vertex;
    for (int axis = 0; axis < 3; ++axis)
        if (const std::string_view word = next_word(); !parse_number(word, vertex[axis]))
            lines.damaged("{} is no coordinate{}", in_quotes(word), whose);
    return vertex;
}

} // namespace forceshade::mesh_file
