#include "host/mesh_file/ply_header.h"

#include <array>
#include <optional>
#include <utility>

#include <fmt/format.h>

#include "host/mesh_file/text_lines.h"

namespace forceshade::mesh_file {
namespace {

struct TypeName {
    std::string_view name, other_name;
    PlyType type;
};

constexpr std::array kTypes{
    TypeName{"char", "int8", PlyType::int8},        TypeName{"uchar", "uint8", PlyType::uint8},
    TypeName{"short", "int16", PlyType::int16},     TypeName{"ushort", "uint16", PlyType::uint16},
    TypeName{"int", "int32", PlyType::int32},       TypeName{"uint", "uint32", PlyType::uint32},
    TypeName{"float", "float32", PlyType::float32}, TypeName{"double", "float64", PlyType::float64}};

PlyType parse_type(const TextLines& lines, std::string_view word) {
    for (const TypeName& type : kTypes)
        if (word == type.name || word == type.other_name)
            return type.type;
    lines.damaged(fmt::format("{} is no type of PLY", quoted(word)));
}

PlyEncoding parse_encoding(const TextLines& lines, std::string_view line) {
    const std::string_view encoding = take_word(line);
    if (encoding == "ascii")
        return PlyEncoding::text;
    if (encoding == "binary_little_endian")
        return PlyEncoding::little;
    if (encoding == "binary_big_endian")
        return PlyEncoding::big;
    lines.damaged(
        fmt::format("no format {}; there are ascii, binary_little_endian and binary_big_endian", quoted(encoding)));
}

PlyElement parse_element(const TextLines& lines, std::string_view line) {
    PlyElement element;
    element.name = take_word(line);
    std::int64_t count = 0;
    const std::string_view word = take_word(line);
    if (element.name.empty() || !parse_integer(word, count) || count < 0)
        lines.damaged(fmt::format("expected an element and how many there are of it, got {} {}", quoted(element.name),
                                  quoted(word)));
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

} // namespace

int PlyElement::find(std::string_view property) const {
    for (std::size_t i = 0; i < properties.size(); ++i)
        if (properties[i].name == property)
            return static_cast<int>(i);
    return -1;
}

std::size_t size_of(PlyType type) {
    constexpr std::array<std::size_t, 8> kSizes{1, 1, 2, 2, 4, 4, 4, 8};
    return kSizes[static_cast<std::size_t>(type)];
}

bool is_integer(PlyType type) {
    return type != PlyType::float32 && type != PlyType::float64;
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
            lines.damaged(fmt::format("{} does not belong into the header of a PLY file", quoted(keyword)));
        }
    }
    lines.damaged("the file breaks off within its header");
}

} // namespace forceshade::mesh_file
