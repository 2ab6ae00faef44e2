#include "host/mesh/formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <string>
#include <utility>

#include "host/mesh/surface.h"

namespace forceshade::mesh_file {

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

// STL, text and binary: triangles without vertices of their own.

std::uint64_t read_bits(const char* bytes, std::size_t size, bool big_endian) {
    std::uint64_t bits = 0;
    for (std::size_t i = 0; i < size; ++i)
        bits |= std::uint64_t{static_cast<unsigned char>(bytes[i])} << 8 * (big_endian ? size - 1 - i : i);
    return bits;
}

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
