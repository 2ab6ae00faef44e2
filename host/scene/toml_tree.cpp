#include "host/scene/toml_tree.h"

#include "host/error.h"

#include <algorithm>

#include <fmt/format.h>
#include <toml++/toml.h>

namespace forceshade {

namespace {

constexpr int kMostKeyDots = 32;
constexpr int kDeepest = 16;

Location location(const toml::source_position& position) {
    return {position.line, position.column};
}

// Behind the last quote of the quoted text that begins at `at`, or where it breaks off.
std::size_t end_of_quoted(std::string_view text, std::size_t at) {
    const std::string quotes(3, text[at]);
    const bool multi_line = text.substr(at, 3) == quotes;
    const std::size_t width = multi_line ? 3 : 1;
    for (std::size_t i = at + width; i < text.size(); ++i) {
        if (text[i] == '\n' && !multi_line)
            return i;
        if (text[i] == '\\' && text[at] == '"') {
            ++i;
        } else if (text.substr(i, width) == quotes.substr(0, width)) {
            for (i += width; multi_line && text.substr(i, 1) == quotes.substr(0, 1);) // up to two belong to the text
                ++i;
            return i;
        }
    }
    return text.size();
}

Location location_in(std::string_view text, std::size_t at) {
    const std::string_view before = text.substr(0, at), line = text.substr(before.rfind('\n') + 1);
    const auto begins_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
    const std::size_t length = at - (text.size() - line.size());
    return {static_cast<std::uint32_t>(1 + std::ranges::count(before, '\n')),
            static_cast<std::uint32_t>(1 + std::ranges::count_if(line.substr(0, length), begins_character))};
}

// The TOML library recurses once a level when it frees a table, so a key of a hundred thousand dots would end the
// stack. Dots count while they may belong to one dotted key; what stands in quotes or in a comment ends none.
void refuse_deep_keys(std::string_view text, const std::string& source) {
    int dots = 0;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '"' || c == '\'') {
            at = end_of_quoted(text, at);
            continue;
        }
        if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
            continue;
        }
        if (c == '\n' || c == ',' || c == '=')
            dots = 0;
        if (c == '.' && ++dots > kMostKeyDots)
            fail(source, location_in(text, at), "a key of so many dots is none of this schema's");
        ++at;
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
    if (text.size() > kLargestToml)
        fail(source, {}, fmt::format("it is no scene or study: it has more than {} bytes", kLargestToml));
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
