#include "host/scene/toml_tree.h"

#include "host/error.h"

#include <algorithm>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace forceshade {

namespace {

constexpr std::size_t kLargestText = std::size_t{16} << 20; // bytes; a study is a page or two
constexpr int kMostKeyDots = 32;
constexpr int kDeepest = 16;

Location location(const toml::source_position& position) {
    return {position.line, position.column};
}

// The TOML library recurses once a level when it frees a table, so a key of a hundred thousand dots would end the
// stack. Dots count while they may belong to one dotted key; two in a row never do.
void refuse_deep_keys(std::string_view text, const std::string& source) {
    Location at{1, 0};
    int dots = 0;
    char previous = '\n';
    bool comment = false;
    for (const char c : text) {
        at.column += (static_cast<unsigned char>(c) & 0xC0) != 0x80;
        if (c == '\n')
            at = {at.line + 1, 0};
        comment = (comment && c != '\n') || (c == '#' && previous == '\n');
        if (c == '.')
            dots = previous == '.' ? 0 : dots + 1;
        else if (c == '\n' || c == ',' || c == '=' || c == '{' || c == '[')
            dots = 0;
        if (!comment && dots > kMostKeyDots)
            fail(source, at, "a key of so many dots is none of this schema's");
        if (c != ' ' && c != '\t')
            previous = c;
    }
}

TomlNode convert(const toml::node& node, const std::string& source, int depth);

void convert_members(const toml::table& table, TomlNode& result, const std::string& source, int depth) {
    for (const auto& [key, value] : table)
        result.members.push_back(
            {std::string(key.str()), location(key.source().begin), convert(value, source, depth + 1)});
    std::sort(result.members.begin(), result.members.end(),
              [](const TomlMember& a, const TomlMember& b) { return a.where < b.where; });
}

TomlNode convert(const toml::node& node, const std::string& source, int depth) {
    TomlNode result;
    result.where = location(node.source().begin);
    if (depth > kDeepest)
        fail(source, result.where, "tables or lists nested this deep are none of this schema's");
    if (const auto* table = node.as_table()) {
        convert_members(*table, result, source, depth);
    } else if (const auto* array = node.as_array()) {
        result.type = TomlNode::Type::array;
        for (const toml::node& item : *array)
            result.items.push_back(convert(item, source, depth + 1));
    } else if (const auto* string = node.as_string()) {
        result.type = TomlNode::Type::string;
        result.text = string->get();
    } else if (const auto* integer = node.as_integer()) {
        result.type = TomlNode::Type::integer;
        result.integer = integer->get();
    } else if (const auto* real = node.as_floating_point()) {
        result.type = TomlNode::Type::real;
        result.real = real->get();
    } else {
        result.type = node.is_boolean() ? TomlNode::Type::boolean : TomlNode::Type::date;
    }
    return result;
}

} // namespace

std::string describe(const TomlNode& node) {
    switch (node.type) {
    case TomlNode::Type::string:
        return toml_string(node.text);
    case TomlNode::Type::integer:
        return fmt::format("{}", node.integer);
    case TomlNode::Type::real:
        return fmt::format("{}", node.real);
    case TomlNode::Type::boolean:
        return "a boolean";
    case TomlNode::Type::date:
        return "a date or time";
    case TomlNode::Type::array:
        return "a list";
    case TomlNode::Type::table:
        break;
    }
    return "a table";
}

TomlNode parse_toml(std::string_view text, const std::string& source) {
    if (text.size() > kLargestText)
        fail(source, {},
             fmt::format("{} bytes are too many for a scene or study; the limit is {}", text.size(), kLargestText));
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        fail(source, {1, 1}, "the text is UTF-16; save it as UTF-8");
    refuse_deep_keys(text, source);
    try {
        return convert(toml::parse(text, std::string_view(source)), source, 0);
    } catch (const toml::parse_error& error) {
        fail(source, location(error.source().begin), std::string(error.description()));
    }
}

std::string toml_string(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            result += '\\';
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        else
            result += c;
    }
    return result + '"';
}

} // namespace forceshade
