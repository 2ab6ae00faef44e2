// OFF, the Object File Format of Geomview, as text: OFF, COFF, NOFF, STOFF and their combinations.
#include <algorithm>
#include <optional>
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
        next_line("its keyword OFF");
        std::string_view word = take_word(line_);
        std::int64_t count = 0;
        if (parse_integer(word, count))
            begins_with_off_ = false;
        else if (word = count_behind(word); word.empty())
            word = take_word(line_);
        if (word == "BINARY")
            throw UsageError(fmt::format("{}: binary OFF is not read; save it as text, or as PLY", name_));
        if (word.empty()) {
            next_line("its numbers of vertices and facets");
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
            throw UsageError(
                fmt::format("{}: {} has vertices of other than three coordinates", name_, in_quotes(word)));
        return keyword->count;
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

    // What follows the coordinates in a line (a normal, a colour, a texture position) is ignored.
    void read_vertex() {
        next_line(fmt::format("vertex {} of {}", soup_.vertices.size(), vertices_));
        const std::string whose = fmt::format(" of vertex {}", soup_.vertices.size());
        soup_.vertices.push_back(read_coordinates(lines_, whose, [&] { return take_word(line_); }));
    }

    void read_facet() {
        next_line(fmt::format("facet {} of {}", facet_, facets_));
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
            next_line(fmt::format("all corners of facet {}", facet_));
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
