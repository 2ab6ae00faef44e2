// PLY, the Polygon File Format, as text and binary: the vertices' x, y, z, and the lists of vertices of faces and of
// triangle strips.
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/formats.h"

namespace forceshade::mesh_file {

namespace {

enum class PlyEncoding { text, little, big };
constexpr std::array<std::string_view, 3> kEncodings{"ascii", "binary_little_endian", "binary_big_endian"};
constexpr std::array<const char*, 3> kFlavours{"PLY (text)", "PLY (binary, little endian)", "PLY (binary, big endian)"};
enum class PlyType { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

struct PlyProperty {
    std::string name;
    PlyType type; // of the value, or of each item of a list
    bool list = false;
    PlyType count_type = PlyType::uint8; // of a list's length
};

struct PlyElement {
    std::string name;
    std::uint64_t count = 0;
    std::vector<PlyProperty> properties;

    /// The position of a property, or -1.
    int find(std::string_view property) const {
        const auto found = std::ranges::find(properties, property, &PlyProperty::name);
        return found == properties.end() ? -1 : static_cast<int>(found - properties.begin());
    }
};

struct PlyHeader {
    PlyEncoding encoding = PlyEncoding::text;
    std::vector<PlyElement> elements;
    std::size_t bytes = 0; // where the data begin
    std::size_t lines = 0;
};

std::size_t size_of(PlyType type) {
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) {
    return type != PlyType::float32 && type != PlyType::float64;
}

bool is_unsigned(PlyType type) {
    return type == PlyType::uint8 || type == PlyType::uint16 || type == PlyType::uint32;
}

PlyType parse_type(const TextLines& lines, std::string_view word) {
    constexpr std::string_view kNames[][2] = {{"char", "int8"},     {"uchar", "uint8"},   {"short", "int16"},
                                              {"ushort", "uint16"}, {"int", "int32"},     {"uint", "uint32"},
                                              {"float", "float32"}, {"double", "float64"}};
    for (std::size_t i = 0; i < std::size(kNames); ++i)
        if (word == kNames[i][0] || word == kNames[i][1])
            return static_cast<PlyType>(i);
    lines.damaged("{} is not a PLY type", in_quotes(word));
}

PlyEncoding parse_encoding(const TextLines& lines, std::string_view line) {
    const std::string_view encoding = take_word(line);
    for (std::size_t i = 0; i < kEncodings.size(); ++i)
        if (encoding == kEncodings[i])
            return static_cast<PlyEncoding>(i);
    lines.damaged("no format {}; there are ascii, binary_little_endian and binary_big_endian", in_quotes(encoding));
}

PlyElement parse_element(const TextLines& lines, std::string_view line) {
    PlyElement element;
    element.name = take_word(line);
    std::int64_t count = 0;
    const std::string_view word = take_word(line);
    if (element.name.empty() || !parse_integer(word, count) || count < 0)
        lines.damaged("expected an element and how many there are of it, got {} {}", in_quotes(element.name),
                      in_quotes(word));
    element.count = static_cast<std::uint64_t>(count);
    return element;
}

PlyProperty parse_property(const TextLines& lines, std::string_view line) {
    PlyProperty property{};
    std::string_view word = take_word(line);
    if (word == "list") {
        property.list = true;
        property.count_type = parse_type(lines, take_word(line));
        if (!is_integer(property.count_type))
            lines.damaged("the length of a list must be an integer");
        word = take_word(line);
    }
    property.type = parse_type(lines, word);
    property.name = take_word(line);
    if (property.name.empty())
        lines.damaged("a property without a name");
    return property;
}

PlyHeader read_ply_header(const std::string& file, std::string_view bytes) {
    TextLines lines(file, bytes);
    std::string_view line;
    if (!lines.next(line) || take_word(line) != "ply")
        lines.damaged("a PLY file begins with a line that says ply");
    PlyHeader header;
    std::optional<PlyEncoding> encoding;
    while (lines.next(line)) {
        const std::string_view keyword = take_word(line);
        if (keyword == "format") {
            encoding = parse_encoding(lines, line);
        } else if (keyword == "element") {
            header.elements.push_back(parse_element(lines, line));
        } else if (keyword == "property") {
            if (header.elements.empty())
                lines.damaged("a property before the first element");
            header.elements.back().properties.push_back(parse_property(lines, line));
        } else if (keyword == "end_header") {
            if (!encoding)
                lines.damaged("the header has no line with the format");
            header.encoding = *encoding;
            header.bytes = bytes.size() - lines.rest().size();
            header.lines = lines.line_number();
            return header;
        } else if (!keyword.empty() && keyword != "comment" && keyword != "obj_info") {
            lines.damaged("{} does not belong into the header of a PLY file", in_quotes(keyword));
        }
    }
    lines.damaged("the file breaks off within its header");
}

// The values of a text file: an element a line.
class TextValues {
public:
    TextValues(const Source& source, const PlyHeader& header)
        : lines_(source.name, source.bytes.substr(header.bytes), header.lines) {}

    void begin_item(std::string_view what) {
        std::string_view words;
        do {
            if (!lines_.next(line_))
                fail("the file breaks off before {}", what);
            words = line_;
        } while (take_word(words).empty());
    }
    void end_item() {
        if (const std::string_view word = take_word(line_); !word.empty())
            fail("{} behind the last property", in_quotes(word));
    }
    double number(PlyType) {
        double value = 0;
        const std::string_view word = take_word(line_);
        if (word.empty() || !parse_number(word, value))
            fail("expected a number, got {}", in_quotes(word));
        return value;
    }
    std::int64_t integer(PlyType) {
        std::int64_t value = 0;
        const std::string_view word = take_word(line_);
        if (!parse_integer(word, value))
            fail("expected an integer, got {}", in_quotes(word));
        return value;
    }
    void skip(PlyType, std::uint64_t values) {
        for (std::uint64_t i = 0; i < values; ++i)
            if (take_word(line_).empty())
                fail("fewer values than the header announces");
    }
    std::uint64_t bytes_left() const { return line_.size() + lines_.rest().size(); }
    static std::uint64_t least_bytes(PlyType) { return 1; } // a digit; the blank behind it may be missing once
    static constexpr std::string_view kWhere = "in line";
    std::size_t place() const { return lines_.line_number(); }
    // Text behind the last element is skipped.
    bool at_end(Skipped& skipped) {
        std::string_view line;
        while (lines_.next(line)) {
            std::string_view words = line;
            if (take_word(words).empty())
                continue;
            if (has_only_numbers(line))
                return false;
            skipped.add(kTextLine, place());
        }
        return true;
    }
    template <typename... Parts> [[noreturn]] void fail(fmt::format_string<Parts...> message, Parts&&... parts) const {
        lines_.damaged(message, std::forward<Parts>(parts)...);
    }

private:
    TextLines lines_;
    std::string_view line_;
};

class BinaryValues {
public:
    BinaryValues(const Source& source, const PlyHeader& header)
        : name_(source.name), bytes_(source.bytes), at_(header.bytes),
          big_endian_(header.encoding == PlyEncoding::big) {}

    void begin_item(std::string_view) {}
    void end_item() {}
    double number(PlyType type) {
        if (type == PlyType::float32)
            return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(next_bits(type))));
        return type == PlyType::float64 ? std::bit_cast<double>(next_bits(type)) : static_cast<double>(integer(type));
    }
    std::int64_t integer(PlyType type) {
        const std::uint64_t bits = next_bits(type);
        const std::size_t unused = 64 - 8 * size_of(type);
        return is_unsigned(type) ? static_cast<std::int64_t>(bits)
                                 : static_cast<std::int64_t>(bits << unused) >> unused;
    }
    void skip(PlyType type, std::uint64_t values) {
        need(values <= bytes_left() / size_of(type));
        at_ += static_cast<std::size_t>(values) * size_of(type);
    }
    std::uint64_t bytes_left() const { return bytes_.size() - at_; }
    static std::uint64_t least_bytes(PlyType type) { return size_of(type); }
    static constexpr std::string_view kWhere = "at byte";
    std::size_t place() const { return at_; }
    bool at_end(Skipped&) const { return bytes_.find_first_not_of(" \t\r\n", at_) == std::string_view::npos; }
    template <typename... Parts> [[noreturn]] void fail(fmt::format_string<Parts...> message, Parts&&... parts) const {
        throw IoError("{}: at byte {}: {}", name_, at_, fmt::format(message, std::forward<Parts>(parts)...));
    }

private:
    std::uint64_t next_bits(PlyType type) {
        const std::size_t size = size_of(type);
        need(size <= bytes_left());
        at_ += size;
        return read_bits(bytes_.data() + at_ - size, size, big_endian_);
    }
    void need(bool there) const {
        if (!there)
            fail("the file breaks off within its data");
    }

    std::string name_;
    std::string_view bytes_;
    std::size_t at_;
    bool big_endian_;
};

constexpr Skipped::Kind kEdge{"edge", "edges"};
constexpr Skipped::Kind kShortStrip{"strip of fewer than three vertices", "strips of fewer than three vertices"};

template <typename Values> class PlyReader {
public:
    PlyReader(const Source& source, const PlyHeader& header)
        : header_(header), values_(source, header), normals_(source.normals) {}

    PolygonFile read() {
        read_elements();
        check_range();
        if (!vertex_normals_.empty())
            for (const std::uint32_t vertex : soup_.corners)
                soup_.normals.push_back(vertex_normals_[vertex]);
        return {std::move(soup_), "", kFlavours[static_cast<std::size_t>(header_.encoding)], skipped_.warnings()};
    }

    /// Of a part of a file; none where something was skipped.
    std::optional<PolygonSoup> read_part() {
        read_elements();
        return skipped_.empty() ? std::optional(std::move(soup_)) : std::nullopt;
    }

private:
    void read_elements() {
        check_announced();
        for (const PlyElement& element : header_.elements) {
            if (is_vertices(element))
                read_vertices(element);
            else if (element.name == "face" || element.name == "faces")
                read_lists(element, "all faces", [&](const PlyProperty& indices) { read_corners(indices); });
            else if (element.name == "tristrips" || element.name == "tristrip")
                read_lists(element, "all triangle strips", [&](const PlyProperty& indices) { read_strips(indices); });
            else if (!element.properties.empty())
                for (std::uint64_t item = 0; item < element.count; ++item)
                    skip_item(element);
        }
        if (!values_.at_end(skipped_))
            values_.fail("the file goes on behind the elements that it announces");
    }

    static bool is_vertices(const PlyElement& element) {
        return element.name == "vertex" || element.name == "vertices";
    }

    void check_announced() const {
        std::uint64_t left = values_.bytes_left() + 1; // the last line end of a text may be missing
        for (const PlyElement& element : header_.elements) {
            std::uint64_t item = 0;
            for (const PlyProperty& property : element.properties)
                item += Values::least_bytes(property.list ? property.count_type : property.type);
            if (item > 0 && element.count > left / item)
                values_.fail(
                    "{} of element {} are announced, which {} bytes cannot hold; the file is damaged or truncated",
                    element.count, in_quotes(element.name), values_.bytes_left());
            left -= item * element.count;
        }
    }

    void read_vertices(const PlyElement& element) {
        const auto is_number = [&](int place) {
            return place >= 0 && !element.properties[static_cast<std::size_t>(place)].list;
        };
        // Six numbers at most: where the vertex is, and its normal.
        std::array<int, 6> places{element.find("x"), element.find("y"), element.find("z"), -1, -1, -1};
        if (!std::all_of(places.begin(), places.begin() + 3, is_number))
            values_.fail("the vertices have no x, y and z");
        if (normals_) {
            const std::array<int, 3> found{element.find("nx"), element.find("ny"), element.find("nz")};
            if (std::ranges::all_of(found, is_number))
                std::ranges::copy(found, places.begin() + 3);
        }
        soup_.vertices.reserve(static_cast<std::size_t>(element.count));
        for (std::uint64_t item = 0; item < element.count; ++item) {
            values_.begin_item("all vertices");
            std::array<double, 6> numbers{};
            for (std::size_t i = 0; i < element.properties.size(); ++i) {
                const auto place = std::ranges::find(places, static_cast<int>(i));
                if (place != places.end())
                    numbers[static_cast<std::size_t>(place - places.begin())] =
                        values_.number(element.properties[i].type);
                else
                    skip(element.properties[i]);
            }
            values_.end_item();
            soup_.vertices.emplace_back(numbers[0], numbers[1], numbers[2]);
            if (places[3] >= 0)
                vertex_normals_.emplace_back(numbers[3], numbers[4], numbers[5]);
        }
    }

    // Faces or strips; `what`: "all faces", and `read` takes the list of their vertices.
    template <typename Read> void read_lists(const PlyElement& element, std::string_view what, const Read& read) {
        if (element.count == 0)
            return;
        int list = element.find("vertex_indices");
        if (list < 0)
            list = element.find("vertex_index");
        const PlyProperty* indices = list < 0 ? nullptr : &element.properties[static_cast<std::size_t>(list)];
        if (!indices || !indices->list || !is_integer(indices->type))
            values_.fail("the {} have no list of integers vertex_indices or vertex_index", what.substr(4));
        soup_.begins.reserve(static_cast<std::size_t>(element.count) + soup_.begins.size());
        for (std::uint64_t item = 0; item < element.count; ++item) {
            values_.begin_item(what);
            for (const PlyProperty& property : element.properties)
                if (&property == indices)
                    read(property);
                else
                    skip(property);
            values_.end_item();
        }
    }

    std::uint64_t list_length(const PlyProperty& property) {
        const std::int64_t length = values_.integer(property.count_type);
        if (length < 0 ||
            static_cast<std::uint64_t>(length) > values_.bytes_left() / Values::least_bytes(property.type))
            values_.fail("a list of {} values, which the rest of the file cannot hold", length);
        return static_cast<std::uint64_t>(length);
    }

    void read_corners(const PlyProperty& property) {
        const std::size_t place = values_.place(), begin = soup_.corners.size();
        const std::uint64_t count = list_length(property);
        for (std::uint64_t corner = 0; corner < count; ++corner)
            soup_.corners.push_back(vertex(values_.integer(property.type)));
        if (count >= 3) {
            soup_.end_facet();
        } else {
            soup_.corners.resize(begin);
            skipped_.add(kShortFaces[count], place);
        }
    }

    std::uint32_t vertex(std::int64_t index) {
        if (index < 0 || index > kMost)
            values_.fail("facet {} has vertex {}; the first is 0", soup_.facets(), index);
        highest_ = std::max(highest_, index);
        return static_cast<std::uint32_t>(index);
    }

    // Vertices a b c d e ... are the triangles (a, b, c), (c, b, d), (c, d, e), ...: every second one is turned, so
    // that all face the same way. -1 ends a strip, and the next one begins unturned. A vertex that is given twice turns
    // a strip or joins it to another: triangles with two equal corners are not part of the surface.
    void read_strips(const PlyProperty& property) {
        const std::uint64_t count = list_length(property);
        std::uint64_t length = 0; // of the strip so far
        std::array<std::uint32_t, 2> last{};
        std::size_t begin = values_.place();
        const auto end_strip = [&] {
            if (length == 1 || length == 2)
                skipped_.add(kShortStrip, begin);
            length = 0;
        };
        for (std::uint64_t item = 0; item < count; ++item) {
            const std::int64_t index = values_.integer(property.type);
            if (is_strip_end(index, property.type)) {
                end_strip();
                begin = values_.place();
                continue;
            }
            const std::uint32_t next = vertex(index);
            if (length >= 2 && last[0] != last[1] && next != last[0] && next != last[1])
                add_triangle(last[length % 2], last[1 - length % 2], next);
            last = {last[1], next};
            ++length;
        }
        end_strip();
    }

    // An unsigned type's -1 is its largest number, unless there is such a vertex.
    bool is_strip_end(std::int64_t index, PlyType type) const {
        if (index == -1 || !is_unsigned(type))
            return index == -1;
        if (index != (std::int64_t{1} << 8 * size_of(type)) - 1)
            return false;
        std::uint64_t vertices = 0;
        for (const PlyElement& element : header_.elements)
            vertices += is_vertices(element) ? element.count : 0;
        return static_cast<std::uint64_t>(index) >= vertices;
    }

    void add_triangle(std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        if (soup_.corners.size() > kMost - 3)
            values_.fail("the triangle strips make more triangles than {}", kMost / 3);
        soup_.corners.insert(soup_.corners.end(), {a, b, c});
        soup_.end_facet();
    }

    void skip(const PlyProperty& property) { values_.skip(property.type, property.list ? list_length(property) : 1); }

    void skip_item(const PlyElement& element) {
        values_.begin_item(element.name);
        if (element.name == "edge" || element.name == "edges")
            skipped_.add(kEdge, values_.place());
        for (const PlyProperty& property : element.properties)
            skip(property);
        values_.end_item();
    }

    // At the end, since faces may stand before vertices.
    void check_range() const {
        if (highest_ >= static_cast<std::int64_t>(soup_.vertices.size()))
            values_.fail("a facet has vertex {}, but there are {}, and the first is 0", highest_,
                         soup_.vertices.size());
    }

    static constexpr std::int64_t kMost = 0xFFFFFFFF; // vertex, and corners

    const PlyHeader& header_;
    Values values_;
    bool normals_; // to be read
    PolygonSoup soup_;
    Skipped skipped_{Values::kWhere};
    std::vector<glm::dvec3> vertex_normals_;
    std::int64_t highest_ = -1;
};

} // namespace

namespace {

// What of each element stands in a block.
PlyHeader header_of(const PlyHeader& header, const TextBlock& block) {
    PlyHeader part = header;
    part.bytes = part.lines = 0;
    std::uint64_t before = block.lines_before;
    std::uint64_t left = block.is_last ? std::numeric_limits<std::uint64_t>::max() : block.lines;
    for (PlyElement& element : part.elements) {
        const std::uint64_t passed = std::min(element.count, before);
        before -= passed;
        element.count = std::min(element.count - passed, left);
        left -= element.count;
    }
    return part;
}

// Strips are read by how many vertices there are, and a block may have none of them.
bool has_parts(const PlyHeader& header) {
    return std::ranges::all_of(header.elements, [](const PlyElement& element) {
        return !element.properties.empty() && !element.name.starts_with("tristrip");
    });
}

} // namespace

PolygonFile read_ply(const Source& source) {
    const PlyHeader header = read_ply_header(source.name, source.bytes);
    if (header.encoding != PlyEncoding::text)
        return PlyReader<BinaryValues>(source, header).read();
    if (!source.normals && has_parts(header))
        if (auto soup = read_in_blocks(source.bytes.substr(header.bytes), "", true, [&](const TextBlock& block) {
                const PlyHeader part = header_of(header, block);
                return PlyReader<TextValues>({source.name, block.text}, part).read_part();
            }))
            return {std::move(*soup), "", kFlavours[static_cast<std::size_t>(header.encoding)]};
    return PlyReader<TextValues>(source, header).read();
}

} // namespace forceshade::mesh_file
