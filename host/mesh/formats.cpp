// OBJ and OFF.
#include "host/mesh/formats.h"

#include <algorithm>
#include <span>

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
        read_statements();
        if (has_text_ && soup_.vertices.empty())
            lines_.damaged("none of the file's lines is a vertex of an OBJ file");
        check_range();
        if (!normals_.empty())
            take_normals();
        return {std::move(soup_), "", "OBJ", skipped_.warnings()};
    }

    /// Of a part of a file; none where what is before it matters, or lines were skipped.
    std::optional<PolygonSoup> read_part() {
        read_statements();
        return is_relative_ || !skipped_.empty() ? std::nullopt : std::optional(std::move(soup_));
    }

private:
    static constexpr std::int64_t kNone = -1; // normal

    void read_statements() {
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
    }

    // A backslash at the end of a line continues it; blanks may stand behind it. In a statement that ends in a name, as
    // `usemtl a\`, and in text it may belong to the name: there it continues the line only if the next line begins with
    // no statement.
    bool next_statement(std::string_view& line) {
        if (!lines_.next_words(line))
            return false;
        if (!continues(line))
            return true;
        is_relative_ = true;
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
        return read_coordinates(
            lines_, [] { return ""; },
            [&] {
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
        if (group_ != 0) {
            is_relative_ = true;
            soup_.groups.resize(soup_.facets(), 0);
        }
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
        is_relative_ = is_relative_ || word.starts_with('-');
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
            lines_.damaged_at(highest_line_, "this facet has vertex {}, but there are {}", highest_,
                              soup_.vertices.size());
    }

    TextLines lines_;
    bool wanted_; // normals
    bool has_text_ = false;
    bool is_relative_ = false; // to what is before: a corner, a group, a line that goes on
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
    if (!source.normals)
        if (auto soup = read_in_blocks(source.bytes, "", false, [&](const TextBlock& block) {
                return ObjReader({source.name, block.text}).read_part();
            }))
            return {std::move(*soup), "", "OBJ"};
    return ObjReader(source).read();
}

// OFF, the Object File Format of Geomview, as text: OFF, COFF, NOFF, STOFF and their combinations.

namespace {

class OffReader {
public:
    explicit OffReader(const Source& source) : name_(source.name), lines_(source.name, source.bytes) {}

    PolygonFile read() {
        read_header();
        soup_.vertices.reserve(vertices_);
        soup_.begins.reserve(facets_ + 1);
        for (std::size_t vertex = 0; vertex < vertices_; ++vertex)
            read_vertex();
        for (facet_ = 0; facet_ < facets_; ++facet_)
            read_facet();
        while (lines_.next_words(line_)) {
            if (has_only_numbers(line_))
                lines_.damaged("the file goes on behind the {} vertices and {} facets that it announces", vertices_,
                               facets_);
            skipped_.add(kTextLine, lines_.line_number());
        }
        std::vector<std::string> warnings = skipped_.warnings();
        if (!begins_with_off_)
            warnings.insert(warnings.begin(), "does not begin with OFF; read all the same");
        return {std::move(soup_), "", "OFF", std::move(warnings)};
    }

private:
    void read_header() {
        next_line([] { return "its keyword OFF"; });
        std::string_view word = take_word(line_);
        std::int64_t count = 0;
        if (parse_integer(word, count))
            begins_with_off_ = false;
        else if (word = count_behind(word); word.empty())
            word = take_word(line_);
        if (word == "BINARY")
            throw UsageError("{}: binary OFF is not read; save it as text, or as PLY", name_);
        if (word.empty()) {
            next_line([] { return "its numbers of vertices and facets"; });
            word = take_word(line_);
        }
        vertices_ = announced(word, "vertices");
        const auto next_count = [&] { return (word = take_word(line_)).empty() ? word = lone_count() : word; };
        facets_ = announced(next_count(), "facets");
        next_count(); // of edges: of no use
        const std::size_t left = lines_.rest().size();
        // `0 0 0` and `0`, a facet without corners, are the shortest lines; the last one's end may be missing.
        if (vertices_ > left / 6 + 1 || facets_ > left / 2 + 1 || vertices_ * 6 + facets_ * 2 > left + 1)
            lines_.damaged(
                "{} vertices and {} facets are announced, which {} bytes cannot hold; the file is damaged or truncated",
                vertices_, facets_, left);
    }

    // The next line, if it is an integer alone; else empty, and that line is still to be read.
    std::string_view lone_count() {
        TextLines ahead = lines_;
        std::string_view line;
        std::int64_t count = 0;
        if (!ahead.next_words(line))
            return {};
        const std::string_view word = take_word(line);
        if (!parse_integer(word, count) || !take_word(line).empty())
            return {};
        lines_ = ahead;
        return word;
    }

    // The count that stands behind the keyword without a blank, or none.
    std::string_view count_behind(std::string_view word) const {
        const std::optional<OffKeyword> keyword = parse_off_keyword(word);
        if (!keyword)
            lines_.damaged("an OFF file begins with OFF, not with {}", in_quotes(word));
        if (keyword->prefix.find_first_of("4n") != std::string_view::npos)
            throw UsageError("{}: {} has vertices of other than three coordinates", name_, in_quotes(word));
        return keyword->count;
    }

    std::size_t announced(std::string_view word, std::string_view what) const {
        std::int64_t count = 0;
        if (!parse_integer(word, count) || count < 0)
            lines_.damaged("expected the number of {}, got {}", what, in_quotes(word));
        return static_cast<std::size_t>(count);
    }

    template <typename Expected> void next_line(const Expected& expected) {
        if (!lines_.next_words(line_))
            lines_.damaged("the file breaks off before {}", expected());
    }

    // What follows the coordinates in a line (a normal, a colour, a texture position) is ignored.
    void read_vertex() {
        next_line([&] { return fmt::format("vertex {} of {}", soup_.vertices.size(), vertices_); });
        const auto whose = [&] { return fmt::format(" of vertex {}", soup_.vertices.size()); };
        soup_.vertices.push_back(read_coordinates(lines_, whose, [&] { return take_word(line_); }));
    }

    void read_facet() {
        next_line([&] { return fmt::format("facet {} of {}", facet_, facets_); });
        const std::size_t line = lines_.line_number(), begin = soup_.corners.size();
        const std::size_t count = announced(take_word(line_), "corners of a facet");
        if (count > line_.size() / 2 + lines_.rest().size() / 2)
            lines_.damaged("a facet with {} corners, more than the file's bytes can hold", count);
        for (std::size_t corner = 0; corner < count; ++corner)
            soup_.corners.push_back(read_corner());
        if (count >= 3) {
            soup_.end_facet();
        } else {
            soup_.corners.resize(begin);
            skipped_.add(kShortFaces[count], line);
        }
    }

    // A long facet may go on in the next line.
    std::uint32_t read_corner() {
        std::string_view word = take_word(line_);
        if (word.empty()) {
            next_line([&] { return fmt::format("all corners of facet {}", facet_); });
            word = take_word(line_);
        }
        std::int64_t index = 0;
        if (!parse_integer(word, index))
            lines_.damaged("{} is not a vertex", in_quotes(word));
        if (index < 0 || index >= static_cast<std::int64_t>(vertices_))
            lines_.damaged("no vertex {}; there are {}, and the first is 0", index, vertices_);
        return static_cast<std::uint32_t>(index);
    }

    std::string name_;
    TextLines lines_;
    std::string_view line_;
    PolygonSoup soup_;
    Skipped skipped_{"in line"};
    std::size_t vertices_ = 0, facets_ = 0;
    bool begins_with_off_ = true;
    std::size_t facet_ = 0; // the one that is read, from 0
};

} // namespace

std::optional<OffKeyword> parse_off_keyword(std::string_view word) {
    const std::size_t at = std::min(word.find("OFF"), word.find("off"));
    if (at == std::string_view::npos)
        return {};
    const OffKeyword keyword{word.substr(0, at), word.substr(at + 3)};
    const bool known = keyword.prefix.find_first_not_of("STCN4n") == std::string_view::npos &&
                       keyword.count.find_first_not_of("0123456789") == std::string_view::npos;
    return known ? std::optional(keyword) : std::nullopt;
}

PolygonFile read_off(const Source& source) {
    return OffReader(source).read();
}

} // namespace forceshade::mesh_file
