#include "host/mesh/formats.h"

#include <algorithm>
#include <array>
#include <bit>
#include <span>
#include <string>
#include <utility>

#include "host/numbers.h"

namespace forceshade::mesh_file {

// Wavefront OBJ: `v` and `f` statements. Elements other than facets are skipped with a count; the other statements of
// the format do not affect the polygons.

namespace {

constexpr std::array kNameStatements = std::to_array<std::string_view>(
    {"g", "o", "usemtl", "usemap", "mtllib", "maplib", "shadow_obj", "trace_obj", "call", "csh"});

constexpr std::array kOtherStatements = std::to_array<std::string_view>(
    {"vt",       "vn",       "vp",    "vc",    "s",    "mg",   "bevel", "lod", "cstype", "deg",
     "bmat",     "step",     "curv2", "parm",  "trim", "hole", "scrv",  "sp",  "end",    "con",
     "c_interp", "d_interp", "ctech", "stech", "bsp",  "bzp",  "cdc",   "cdp", "res"});

struct ObjElement {
    std::string_view keyword;
    Skipped::Kind kind;
};
constexpr std::array<ObjElement, 4> kElements{{{"l", {"line element (l)", "line elements (l)"}},
                                               {"p", {"point element (p)", "point elements (p)"}},
                                               {"curv", {"free-form curve (curv)", "free-form curves (curv)"}},
                                               {"surf", {"free-form surface (surf)", "free-form surfaces (surf)"}}}};

bool is_one_of(std::string_view word, std::span<const std::string_view> words) {
    return std::ranges::find(words, word) != words.end();
}

bool is_facet(std::string_view keyword) {
    return keyword == "f" || keyword == "fo"; // fo: before version 3 of the format
}

class ObjReader {
public:
    explicit ObjReader(const Source& source) : lines_(source.name, source.bytes), wanted_(source.normals) {}

    PolygonFile read() {
        std::string_view line;
        while (next_statement(line)) {
            const std::string_view keyword = take_word(line);
            if (keyword == "v")
                soup_.vertices.push_back(read_vector(line, "a vertex"));
            else if (keyword == "vn" && wanted_)
                normals_.push_back(read_vector(line, "a normal"));
            else if (is_facet(keyword))
                read_facet(line);
            else if (keyword == "s")
                read_group(line);
            else if (!is_one_of(keyword, kNameStatements) && !is_one_of(keyword, kOtherStatements))
                skip_element_or_text(keyword, line);
        }
        if (has_text_ && soup_.vertices.empty())
            lines_.damaged("none of the file's lines is a vertex of an OBJ file");
        check_range();
        if (!normals_.empty())
            take_normals();
        return {std::move(soup_), "", "OBJ", skipped_.warnings()};
    }

private:
    static constexpr std::int64_t kNone = -1; // normal

    // A backslash at the end of a line continues it; blanks may stand behind it. In a statement that ends in a name, as
    // `usemtl a\`, and in text it may belong to the name: there it continues the line only if the next line begins with
    // no statement.
    bool next_statement(std::string_view& line) {
        if (!lines_.next_words(line))
            return false;
        if (!continues(line))
            return true;
        std::string_view words = line;
        const std::string_view keyword = take_word(words);
        const bool may_be_name = !is_data(keyword);
        joined_.clear();
        while (continues(line) && !(may_be_name && next_line_is_statement())) {
            joined_.append(line.substr(0, line.rfind('\\'))).push_back(' ');
            if (!lines_.next(line))
                lines_.damaged("the file ends in a line that is to be continued");
            line = line.substr(0, line.find('#'));
        }
        joined_.append(line);
        line = joined_;
        return true;
    }

    static bool continues(std::string_view line) {
        const std::size_t last = line.find_last_not_of(" \t\v\f");
        return last != std::string_view::npos && line[last] == '\\';
    }

    static bool is_data(std::string_view keyword) {
        return keyword == "v" || is_facet(keyword) || is_one_of(keyword, kOtherStatements) ||
               std::ranges::find(kElements, keyword, &ObjElement::keyword) != kElements.end();
    }

    // True also for the end, an empty line and a comment.
    bool next_line_is_statement() const {
        TextLines ahead = lines_;
        std::string_view line;
        if (!ahead.next(line))
            return true;
        line = line.substr(0, line.find('#'));
        const std::string_view keyword = take_word(line);
        return keyword.empty() || is_data(keyword) || is_one_of(keyword, kNameStatements);
    }

    void skip_element_or_text(std::string_view keyword, std::string_view line) {
        const auto element = std::ranges::find(kElements, keyword, &ObjElement::keyword);
        if (element == kElements.end() &&
            (has_only_numbers(line) || (has_only_numbers(keyword) && take_word(line).empty())))
            lines_.damaged("unknown OBJ keyword {}", in_quotes(keyword));
        has_text_ = has_text_ || element == kElements.end();
        skipped_.add(element == kElements.end() ? kTextLine : element->kind, lines_.line_number());
    }

    glm::dvec3 read_vector(std::string_view line, const char* what) {
        return read_coordinates(lines_, "", [&] {
            const std::string_view word = take_word(line);
            if (word.empty())
                lines_.damaged("{} has three coordinates; the file is damaged or breaks off here", what);
            return word;
        });
    }

    // `s 1`; `s 0` and `s off` are none, and so is any other word.
    void read_group(std::string_view line) {
        std::int64_t number = 0;
        const std::string_view word = take_word(line);
        group_ = parse_integer(word, number) && number > 0 && number <= std::int64_t{0xFFFFFFFF}
                     ? static_cast<std::uint32_t>(number)
                     : 0;
        if (group_ != 0)
            soup_.groups.resize(soup_.facets(), 0);
    }

    void end_facet() {
        soup_.end_facet();
        if (!soup_.groups.empty() || group_ != 0)
            soup_.groups.resize(soup_.facets(), group_);
    }

    void read_facet(std::string_view line) {
        const std::size_t begin = soup_.corners.size();
        std::size_t count = 0;
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++count)
            soup_.corners.push_back(corner(word));
        if (count >= 3) {
            end_facet();
            return;
        }
        if (!lines_.line_has_end())
            lines_.damaged("a facet has three corners or more, got {}; the file breaks off here, unless a line end is "
                           "all that is missing",
                           count);
        soup_.corners.resize(begin);
        if (wanted_)
            corner_normals_.resize(begin);
        skipped_.add(kShortFaces[count], lines_.line_number());
    }

    // `7`, `7/1`, `7//3`, `7/1/3`; -1 is the last vertex so far. Vertices may follow the facets that use them.
    std::uint32_t corner(std::string_view word) {
        std::int64_t index = 0;
        const auto known = static_cast<std::int64_t>(soup_.vertices.size());
        const std::size_t slash = word.find('/');
        if (!parse_integer(word.substr(0, slash), index) ||
            (slash != std::string_view::npos && !is_reference(word.substr(slash + 1))))
            lines_.damaged("{} is not a corner of a facet", in_quotes(word));
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
    bool has_text_ = false;
    PolygonSoup soup_;
    Skipped skipped_{"in line"};
    std::vector<glm::dvec3> normals_;
    std::vector<std::int64_t> corner_normals_; // one a corner, from 0, or kNone
    std::string joined_;
    std::uint32_t group_ = 0; // smoothing group of what follows
    std::int64_t highest_ = 0;
    std::size_t highest_line_ = 0;
};

} // namespace

PolygonFile read_obj(const Source& source) {
    return ObjReader(source).read();
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

PolygonFile read_binary(const Source& source) {
    const std::optional<std::size_t> behind = bytes_behind_binary_stl(source.bytes);
    if (!behind) {
        const std::size_t size = source.bytes.size();
        if (size < kHeader)
            throw IoError(
                fmt::format("{}: {} bytes are too few for an STL file, and it is not text; it is damaged or truncated",
                            source.name, size));
        const std::uint64_t triangles = read_bits(source.bytes.data() + 80, 4);
        throw IoError(fmt::format("{}: a binary STL file that announces {} triangles has {} bytes, but this one has "
                                  "{}; it is damaged or truncated",
                                  source.name, triangles, kHeader + kTriangle * triangles, size));
    }
    std::vector<glm::dvec3> corners;
    const std::size_t end = source.bytes.size() - *behind;
    corners.reserve((end - kHeader) / kTriangle * 3);
    for (std::size_t begin = kHeader; begin < end; begin += kTriangle)
        for (int corner = 1; corner <= 3; ++corner) { // behind the normal
            const char* const at = source.bytes.data() + begin + 12 * corner;
            corners.emplace_back(read_float(at), read_float(at + 4), read_float(at + 8));
        }
    std::vector<std::string> warnings;
    if (*behind > 0)
        warnings.push_back(
            fmt::format("{} behind the last triangle (the file announces {}): skipped (at byte {}){}",
                        numbers::counted(*behind, "byte"), (end - kHeader) / kTriangle, end,
                        *behind % kTriangle == 0 ? fmt::format("; they may be {} more", *behind / kTriangle) : ""));
    return {triangles(std::move(corners)), "", "STL (binary)", std::move(warnings)};
}

constexpr std::array kStlKeywords = std::to_array<std::string_view>(
    {"solid", "facet", "normal", "outer", "loop", "vertex", "endloop", "endfacet", "endsolid"});

// Lines of text, such as comments and colours, are skipped wherever a keyword is expected. A keyword in the wrong place
// is an error: something is missing before it.
class StlTextReader {
public:
    explicit StlTextReader(const Source& source) : lines_(source.name, source.bytes) {}

    PolygonFile read() {
        bool open = false;                // a solid that is to end
        std::size_t parts = 0, begin = 0; // the first corner of the solid
        for (;; ++parts) {
            const std::string_view word = next_part(!open);
            if (word.empty())
                break;
            if (is_keyword(word, "facet")) {
                read_facet();
                open = true;
                continue;
            }
            const bool ends = is_keyword(word, "endsolid");
            if (!ends && open && corners_.size() > begin)
                lines_.damaged("expected facet or endsolid, got {}", in_quotes(word));
            open = !ends;
            begin = corners_.size();
            line_ = {}; // the name
        }
        if (parts == 0)
            lines_.damaged("not an STL file: no line begins with solid or facet");
        return {triangles(std::move(corners_)), "", "STL (text)", skipped_.warnings()};
    }

private:
    // Solid, endsolid or facet, left where it is; empty at the end of the file.
    std::string_view next_part(bool may_end) {
        for (;;) {
            const std::string_view word = peek("facet or endsolid", may_end);
            if (word.empty() || is_keyword(word, "facet") || is_keyword(word, "solid") || is_keyword(word, "endsolid"))
                return word;
            skip_text("facet or endsolid", word);
        }
    }

    void skip_text(std::string_view expected, std::string_view word) {
        if (std::ranges::any_of(kStlKeywords, [&](std::string_view keyword) { return is_keyword(word, keyword); }))
            lines_.damaged("expected {}, got {}", expected, in_quotes(word));
        skipped_.add(kTextLine, lines_.line_number());
        line_ = {};
    }

    void read_facet() {
        next_word("facet");
        next_word("normal");
        for (int axis = 0; axis < 3; ++axis) // ignored, often nan
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

    // Of a facet. A number there may be a coordinate, and is not text.
    void next_word(std::string_view keyword) {
        for (;;) {
            const std::string_view word = peek(keyword);
            double value = 0;
            if (is_keyword(word, keyword))
                break;
            if (parse_number(word, value))
                lines_.damaged("expected {}, got {}", keyword, in_quotes(word));
            skip_text(keyword, word);
        }
        take_word(line_);
    }

    TextLines lines_;
    std::string_view line_;
    std::vector<glm::dvec3> corners_;
    Skipped skipped_{"in line"};
};

} // namespace

std::optional<std::size_t> bytes_behind_binary_stl(std::string_view bytes) {
    if (bytes.size() < kHeader)
        return {};
    const std::size_t triangles = read_bits(bytes.data() + 80, 4), needed = kHeader + kTriangle * triangles;
    if (bytes.size() < needed || (triangles == 0 && bytes.size() > needed))
        return {};
    return bytes.size() - needed;
}

PolygonFile read_stl(const Source& source) {
    const bool text = looks_like_text(source.bytes) && !bytes_behind_binary_stl(source.bytes);
    return text ? StlTextReader(source).read() : read_binary(source);
}

} // namespace forceshade::mesh_file
