// Wavefront OBJ: `v` and `f` statements; all others of the format have no bearing on the polygons.
#include <algorithm>
#include <array>
#include <cctype>
#include <string>

#include <fmt/format.h>

#include "host/mesh_file/formats.h"
#include "host/mesh_file/text_lines.h"

namespace forceshade::mesh_file {
namespace {

constexpr std::array kOtherStatements = std::to_array<std::string_view>(
    {"vt",        "vn",     "vp",     "vc",    "g",    "o",      "s",   "mg",   "l",        "p",        "usemtl",
     "usemap",    "mtllib", "maplib", "bevel", "lod",  "cstype", "deg", "bmat", "step",     "curv",     "curv2",
     "surf",      "parm",   "trim",   "hole",  "scrv", "sp",     "end", "con",  "c_interp", "d_interp", "shadow_obj",
     "trace_obj", "ctech",  "stech",  "call",  "csh",  "bsp",    "bzp", "cdc",  "cdp",      "res"});

class ObjReader {
public:
    explicit ObjReader(const Source& source) : lines_(source.name, source.bytes) {}

    PolygonSoup read() {
        std::string_view line;
        while (next_statement(line)) {
            const std::string_view keyword = take_word(line);
            if (keyword == "v")
                read_vertex(line);
            else if (keyword == "f")
                read_facet(line);
            else if (std::ranges::find(kOtherStatements, keyword) == kOtherStatements.end())
                lines_.damaged(fmt::format("{} is no statement of an OBJ file", quoted(keyword)));
        }
        check_range();
        return std::move(soup_);
    }

private:
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

    void read_vertex(std::string_view line) {
        glm::dvec3 vertex;
        for (int axis = 0; axis < 3; ++axis) {
            const std::string_view word = take_word(line);
            if (word.empty())
                lines_.damaged("a vertex has three coordinates; the file is damaged or breaks off here");
            if (!parse_number(word, vertex[axis]))
                lines_.damaged(fmt::format("{} is no coordinate", quoted(word)));
        }
        soup_.vertices.push_back(vertex);
    }

    void read_facet(std::string_view line) {
        std::size_t count = 0;
        for (std::string_view word = take_word(line); !word.empty(); word = take_word(line), ++count)
            soup_.corners.push_back(corner(word));
        if (count < 3)
            lines_.damaged(fmt::format("a facet has three corners or more, got {}; the file is damaged or breaks off "
                                       "here",
                                       count));
        soup_.begins.push_back(static_cast<std::uint32_t>(soup_.corners.size()));
    }

    // `7`, `7/1`, `7//3`, `7/1/3`; -1 is the last vertex so far. Vertices may follow the facets that use them.
    std::uint32_t corner(std::string_view word) {
        std::int64_t index = 0;
        const auto known = static_cast<std::int64_t>(soup_.vertices.size());
        const std::size_t slash = word.find('/');
        if (!parse_integer(word.substr(0, slash), index) ||
            (slash != std::string_view::npos && !is_reference(word.substr(slash + 1))))
            lines_.damaged(fmt::format("{} is no corner of a facet", quoted(word)));
        if (index == 0 || index < -known || index > std::int64_t{0xFFFFFFFF})
            lines_.damaged(fmt::format("no vertex {}; there are {} so far, and the first is 1", index, known));
        if (index > highest_) {
            highest_ = index;
            highest_line_ = lines_.line_number();
        }
        return static_cast<std::uint32_t>(index < 0 ? known + index : index - 1);
    }

    static bool is_reference(std::string_view text) {
        return std::ranges::count(text, '/') <= 1 &&
               std::ranges::all_of(text, [](char c) { return c == '/' || c == '-' || (c >= '0' && c <= '9'); });
    }

    void check_range() const {
        if (highest_ > static_cast<std::int64_t>(soup_.vertices.size()))
            lines_.damaged(fmt::format("the facet in line {} has vertex {}, but there are {}", highest_line_, highest_,
                                       soup_.vertices.size()));
    }

    TextLines lines_;
    PolygonSoup soup_;
    std::string joined_;
    std::int64_t highest_ = 0;
    std::size_t highest_line_ = 0;
};

} // namespace

PolygonSoup read_obj(const Source& source) {
    return ObjReader(source).read();
}

} // namespace forceshade::mesh_file
