// OFF, the Object File Format of Geomview, as text: OFF, COFF, NOFF, STOFF and their combinations.
#include <string>
#include <utility>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/formats.h"

namespace forceshade::mesh_file {

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

} // namespace forceshade::mesh_file
