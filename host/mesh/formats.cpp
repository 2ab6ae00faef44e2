#include "host/mesh/formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <string>
#include <utility>

#include <locale.h>
#include <stdlib.h>

#include "host/mesh/surface.h"

namespace forceshade::mesh_file {

namespace {

// Lines and words are short, and searching through them for one of several characters with string_view's functions
// takes several times as long.
bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

void skip_blanks(std::string_view& line) {
    line.remove_prefix(static_cast<std::size_t>(std::ranges::find_if_not(line, is_blank) - line.begin()));
}

// std::from_chars leaves the value alone where it is beyond the range of double, on either side.
double beyond_range(std::string_view word) {
    static const locale_t classic = ::newlocale(LC_ALL_MASK, "C", nullptr);
    return ::strtod_l(std::string(word).c_str(), nullptr, classic);
}

std::string_view without_plus(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-')
        word.remove_prefix(1);
    return word;
}

} // namespace

TextLines::TextLines(std::string file, std::string_view text, std::size_t number)
    : file_(std::move(file)), text_(text), number_(number) {
    if (text_.starts_with("\xEF\xBB\xBF"))
        text_.remove_prefix(3);
}

bool TextLines::next(std::string_view& line) {
    if (text_.empty())
        return false;
    ++number_;
    const auto end = static_cast<std::size_t>(
        std::ranges::find_if(text_, [](char c) { return c == '\n' || c == '\r'; }) - text_.begin());
    line = text_.substr(0, end);
    if (end == text_.size()) {
        text_ = {};
        return true;
    }
    const bool two = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
    text_.remove_prefix(end + (two ? 2 : 1));
    return true;
}

bool TextLines::next_words(std::string_view& line) {
    while (next(line)) {
        line = line.substr(0, line.find('#'));
        skip_blanks(line);
        if (!line.empty())
            return true;
    }
    return false;
}

std::string_view take_word(std::string_view& line) {
    skip_blanks(line);
    const auto end = static_cast<std::size_t>(std::ranges::find_if(line, is_blank) - line.begin());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

std::string in_quotes(std::string_view word) {
    constexpr std::size_t kMost = 24;
    std::string text = "\"";
    for (const char c : word.substr(0, kMost))
        text += c < ' ' || c == '\x7F' ? '?' : c; // bytes beyond ASCII are negative: shown as ? too
    return text + (word.size() > kMost ? "...\"" : "\"");
}

bool parse_number(std::string_view word, double& value) {
    word = without_plus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument)
        return false;
    if (error == std::errc::result_out_of_range)
        value = beyond_range(word);
    return true;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
    word = without_plus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

bool is_keyword(std::string_view word, std::string_view keyword) {
    return std::ranges::equal(word, keyword,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

std::uint64_t read_bits(const char* bytes, std::size_t size, bool big_endian) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i)
        bits |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << 8 * (big_endian ? size - 1 - i : i);
    return bits;
}

// Wavefront OBJ: `v` and `f` statements; all others of the format have no bearing on the polygons.

namespace {

constexpr std::array kOtherStatements = std::to_array<std::string_view>(
    {"vt",        "vn",     "vp",     "vc",    "g",    "o",      "s",   "mg",   "l",        "p",        "usemtl",
     "usemap",    "mtllib", "maplib", "bevel", "lod",  "cstype", "deg", "bmat", "step",     "curv",     "curv2",
     "surf",      "parm",   "trim",   "hole",  "scrv", "sp",     "end", "con",  "c_interp", "d_interp", "shadow_obj",
     "trace_obj", "ctech",  "stech",  "call",  "csh",  "bsp",    "bzp", "cdc",  "cdp",      "res"});

class ObjReader {
public:
    explicit ObjReader(const Source& source) : lines_(source.name, source.bytes), wanted_(source.normals) {}

    PolygonSoup read() {
        std::string_view line;
        while (next_statement(line)) {
            const std::string_view keyword = take_word(line);
            if (keyword == "v")
                soup_.vertices.push_back(read_vector(line, "a vertex"));
            else if (keyword == "vn" && wanted_)
                normals_.push_back(read_vector(line, "a normal"));
            else if (keyword == "f")
                read_facet(line);
            else if (std::ranges::find(kOtherStatements, keyword) == kOtherStatements.end())
                lines_.damaged("{} is no statement of an OBJ file", in_quotes(keyword));
        }
        check_range();
        if (!normals_.empty())
            take_normals();
        return std::move(soup_);
    }

private:
    static constexpr std::int64_t kNone = -1; // normal

    // A backslash at the end of a line continues it.
    bool next_statement(std::string_view& line) {
        if (!lines_.next_words(line))
            return false;
        if (line.back() != '\\')
            return true;
        joined_.clear();
        while (!line.empty() && line.back() == '\\') {
            joined_.append(line.substr(0, line.size() - 1)).push_back(' ');
            if (!lines_.next(line))
                lines_.damaged("the file ends in a line that is to be continued");
            line = line.substr(0, line.find('#'));
        }
        joined_.append(line);
        line = joined_;
        return true;
    }

    glm::dvec3 read_vector(std::string_view line, const char* what) {
        return read_coordinates(lines_, "", [&] {
            const std::string_view word = take_word(line);
            if (word.empty())
                lines_.damaged("{} has three coordinates; the file is damaged or breaks off here", what);
            return word;
        });
    }

    void read_facet(std::string_view line) {
        std::size_t count = 0;
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++count)
            soup_.corners.push_back(corner(word));
        if (count < 3)
            lines_.damaged("a facet has three corners or more, got {}; the file is damaged or breaks off here", count);
        soup_.end_facet();
    }

    // `7`, `7/1`, `7//3`, `7/1/3`; -1 is the last vertex so far. Vertices may follow the facets that use them.
    std::uint32_t corner(std::string_view word) {
        std::int64_t index = 0;
        const auto known = static_cast<std::int64_t>(soup_.vertices.size());
        const std::size_t slash = word.find('/');
        if (!parse_integer(word.substr(0, slash), index) ||
            (slash != std::string_view::npos && !is_reference(word.substr(slash + 1))))
            lines_.damaged("{} is no corner of a facet", in_quotes(word));
        if (index == 0 || index < -known || index > std::int64_t{0xFFFFFFFF})
            lines_.damaged("no vertex {}; there are {} so far, and the first is 1", index, known);
        if (index > highest_) {
            highest_ = index;
            highest_line_ = lines_.line_number();
        }
        if (wanted_)
            corner_normals_.push_back(normal_of(word));
        return static_cast<std::uint32_t>(index < 0 ? known + index : index - 1);
    }

    static bool is_reference(std::string_view text) {
        return std::ranges::count(text, '/') <= 1 && text.find_first_not_of("/-0123456789") == std::string_view::npos;
    }

    // The number behind the second slash, counted from 0.
    std::int64_t normal_of(std::string_view word) const {
        const std::size_t slash = word.rfind('/');
        std::int64_t index = 0;
        if (std::ranges::count(word, '/') != 2 || !parse_integer(word.substr(slash + 1), index) || index == 0)
            return kNone;
        return index > 0 ? index - 1 : std::max(kNone, static_cast<std::int64_t>(normals_.size()) + index);
    }

    // At the end, since normals may follow the facets that use them.
    void take_normals() {
        for (std::size_t i = 0; i < soup_.corners.size(); ++i) {
            const std::int64_t number = corner_normals_[i];
            if (number == kNone || number >= static_cast<std::int64_t>(normals_.size()))
                lines_.damaged("corner {} of the file's facets (counted from 1) has no normal, or none of the {} that "
                               "there are; a corner is written 7//3 or 7/1/3",
                               i + 1, normals_.size());
            soup_.normals.push_back(normals_[static_cast<std::size_t>(number)]);
        }
    }

    void check_range() const {
        if (highest_ > static_cast<std::int64_t>(soup_.vertices.size()))
            lines_.damaged("the facet in line {} has vertex {}, but there are {}", highest_line_, highest_,
                           soup_.vertices.size());
    }

    TextLines lines_;
    bool wanted_; // normals
    PolygonSoup soup_;
    std::vector<glm::dvec3> normals_;
    std::vector<std::int64_t> corner_normals_; // one a corner, from 0, or kNone
    std::string joined_;
    std::int64_t highest_ = 0;
    std::size_t highest_line_ = 0;
};

} // namespace

PolygonFile read_obj(const Source& source) {
    return {ObjReader(source).read(), "", "OBJ"};
}

// OFF, the Object File Format of Geomview, as text: OFF, COFF, NOFF, STOFF and their combinations.

namespace {

class OffReader {
public:
    explicit OffReader(const Source& source) : name_(source.name), lines_(source.name, source.bytes) {}

    PolygonSoup read() {
        read_header();
        soup_.vertices.reserve(vertices_);
        soup_.begins.reserve(facets_ + 1);
        for (std::size_t vertex = 0; vertex < vertices_; ++vertex)
            read_vertex();
        for (std::size_t facet = 0; facet < facets_; ++facet)
            read_facet();
        if (lines_.next_words(line_))
            lines_.damaged("the file goes on behind the {} vertices and {} facets that it announces", vertices_,
                           facets_);
        return std::move(soup_);
    }

private:
    void read_header() {
        next_line("its keyword OFF");
        check_keyword(take_word(line_));
        std::string_view word = take_word(line_);
        if (word == "BINARY")
            throw UsageError(fmt::format("{}: binary OFF is not read; save it as text, or as PLY", name_));
        if (word.empty()) {
            next_line("its numbers of vertices and facets");
            word = take_word(line_);
        }
        vertices_ = announced(word, "vertices");
        facets_ = announced(take_word(line_), "facets");
        const std::size_t left = lines_.rest().size();
        // `0 0 0` and `3 0 1 2` with their line ends are the shortest lines, but for the last one's end.
        if (vertices_ > left / 6 + 1 || facets_ > left / 8 + 1 || vertices_ * 6 + facets_ * 8 > left + 1)
            lines_.damaged(
                "{} vertices and {} facets are announced, which {} bytes cannot hold; the file is damaged or truncated",
                vertices_, facets_, left);
    }

    void check_keyword(std::string_view keyword) const {
        const std::string_view prefix = keyword.substr(0, keyword.rfind("OFF"));
        if (!keyword.ends_with("OFF") || prefix.find_first_not_of("STCN4n") != std::string_view::npos)
            lines_.damaged("an OFF file begins with OFF, not with {}", in_quotes(keyword));
        if (prefix.find('4') != std::string_view::npos || prefix.find('n') != std::string_view::npos)
            throw UsageError(
                fmt::format("{}: {} has vertices of other than three coordinates", name_, in_quotes(keyword)));
    }

    std::size_t announced(std::string_view word, std::string_view what) const {
        std::int64_t count = 0;
        if (!parse_integer(word, count) || count < 0)
            lines_.damaged("expected the number of {}, got {}", what, in_quotes(word));
        return static_cast<std::size_t>(count);
    }

    void next_line(std::string_view expected) {
        if (!lines_.next_words(line_))
            lines_.damaged("the file breaks off before {}", expected);
    }

    // What follows the coordinates in a line (a normal, a colour, a texture position) is left.
    void read_vertex() {
        next_line(fmt::format("vertex {} of {}", soup_.vertices.size(), vertices_));
        const std::string whose = fmt::format(" of vertex {}", soup_.vertices.size());
        soup_.vertices.push_back(read_coordinates(lines_, whose, [&] { return take_word(line_); }));
    }

    void read_facet() {
        next_line(fmt::format("facet {} of {}", soup_.facets(), facets_));
        const std::size_t count = announced(take_word(line_), "corners of a facet");
        if (count < 3 || count > line_.size() / 2 + lines_.rest().size() / 2)
            lines_.damaged("a facet with {} corners; it has three or more, and no more than the file's bytes can hold",
                           count);
        for (std::size_t corner = 0; corner < count; ++corner)
            soup_.corners.push_back(read_corner());
        soup_.end_facet();
    }

    // A long facet may go on in the next line.
    std::uint32_t read_corner() {
        std::string_view word = take_word(line_);
        if (word.empty()) {
            next_line(fmt::format("all corners of facet {}", soup_.facets()));
            word = take_word(line_);
        }
        std::int64_t index = 0;
        if (!parse_integer(word, index))
            lines_.damaged("{} is no vertex", in_quotes(word));
        if (index < 0 || index >= static_cast<std::int64_t>(vertices_))
            lines_.damaged("no vertex {}; there are {}, and the first is 0", index, vertices_);
        return static_cast<std::uint32_t>(index);
    }

    std::string name_;
    TextLines lines_;
    std::string_view line_;
    PolygonSoup soup_;
    std::size_t vertices_ = 0, facets_ = 0;
};

} // namespace

PolygonFile read_off(const Source& source) {
    return {OffReader(source).read(), "", "OFF"};
}

// STL, text and binary: triangles without vertices of their own.

namespace {

constexpr std::size_t kHeader = 84, kTriangle = 50; // bytes

float read_float(const char* bytes) {
    return std::bit_cast<float>(static_cast<std::uint32_t>(read_bits(bytes, 4)));
}

// Triangles whose vertices are their corners in order.
PolygonSoup triangles(std::vector<glm::dvec3> corners) {
    PolygonSoup soup;
    soup.vertices = std::move(corners);
    for (std::uint32_t corner = 0; corner < soup.vertices.size(); ++corner) {
        soup.vertices[corner] += 0.0; // -0 becomes 0
        soup.corners.push_back(corner);
        if (corner % 3 == 2)
            soup.end_facet();
    }
    return soup;
}

PolygonSoup read_binary(const Source& source) {
    if (!is_binary_stl(source.bytes)) {
        const std::size_t size = source.bytes.size();
        if (size < kHeader)
            throw IoError(
                fmt::format("{}: {} bytes are too few for an STL file, and it is no text; it is damaged or truncated",
                            source.name, size));
        const std::uint64_t triangles = read_bits(source.bytes.data() + 80, 4);
        throw IoError(fmt::format("{}: a binary STL file that announces {} triangles has {} bytes, but this one has "
                                  "{}; it is damaged or truncated",
                                  source.name, triangles, kHeader + kTriangle * triangles, size));
    }
    std::vector<glm::dvec3> corners;
    corners.reserve((source.bytes.size() - kHeader) / kTriangle * 3);
    for (std::size_t begin = kHeader; begin < source.bytes.size(); begin += kTriangle)
        for (int corner = 1; corner <= 3; ++corner) { // behind the normal
            const char* const at = source.bytes.data() + begin + 12 * corner;
            corners.emplace_back(read_float(at), read_float(at + 4), read_float(at + 8));
        }
    return triangles(std::move(corners));
}

class StlTextReader {
public:
    explicit StlTextReader(const Source& source) : lines_(source.name, source.bytes) {}

    PolygonSoup read() {
        while (next_word("solid", true)) {
            line_ = {}; // the name
            while (!is_keyword(peek("facet or endsolid"), "endsolid"))
                read_facet();
            line_ = {};
        }
        return triangles(std::move(corners_));
    }

private:
    void read_facet() {
        next_word("facet");
        next_word("normal");
        for (int axis = 0; axis < 3; ++axis) // what it says has no bearing, and often it is nan
            if (peek("a normal").empty() || take_word(line_).empty())
                lines_.damaged("a normal has three coordinates");
        next_word("outer");
        next_word("loop");
        for (int corner = 0; corner < 3; ++corner)
            read_vertex();
        next_word("endloop");
        next_word("endfacet");
    }

    void read_vertex() {
        next_word("vertex");
        corners_.push_back(read_coordinates(lines_, "", [&] {
            peek("a coordinate");
            return take_word(line_);
        }));
    }

    // The next word, left where it is; empty only at an end of the file that is allowed.
    std::string_view peek(std::string_view expected, bool may_end = false) {
        for (;;) {
            std::string_view words = line_;
            if (const std::string_view word = take_word(words); !word.empty())
                return word;
            if (!lines_.next(line_)) {
                line_ = {};
                if (may_end)
                    return {};
                lines_.damaged("the file breaks off before {}", expected);
            }
        }
    }

    bool next_word(std::string_view keyword, bool may_end = false) {
        const std::string_view word = peek(keyword, may_end);
        if (word.empty())
            return false;
        if (!is_keyword(word, keyword))
            lines_.damaged("expected {}, got {}", keyword, in_quotes(word));
        take_word(line_);
        return true;
    }

    TextLines lines_;
    std::string_view line_;
    std::vector<glm::dvec3> corners_;
};

} // namespace

bool is_binary_stl(std::string_view bytes) {
    return bytes.size() >= kHeader && bytes.size() == kHeader + kTriangle * read_bits(bytes.data() + 80, 4);
}

PolygonFile read_stl(const Source& source) {
    const std::size_t begin = source.bytes.find_first_not_of(" \t\r\n");
    const bool text = begin != std::string_view::npos && is_keyword(source.bytes.substr(begin, 5), "solid");
    if (text && !is_binary_stl(source.bytes))
        return {StlTextReader(source).read(), "", "STL (text)"};
    return {read_binary(source), "", "STL (binary)"};
}

} // namespace forceshade::mesh_file
