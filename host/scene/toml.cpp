#include "host/scene/toml.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <toml++/toml.h>

#include "host/scene/toml_mend.h"

namespace forceshade {

namespace {

constexpr int kMostKeyDots = 32;
constexpr int kDeepest = 16;

Location location(const toml::source_position& position) {
    return {position.line, position.column};
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
    std::ranges::sort(result.members, [](const TomlMember& a, const TomlMember& b) { return a.where < b.where; });
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
    } else if (const auto* boolean = node.as_boolean()) {
        result.type = TomlNode::Type::boolean;
        result.truth = boolean->get();
    } else {
        result.type = TomlNode::Type::date;
    }
    return result;
}

} // namespace

std::string describe(const TomlNode& node) {
    if (node.type == TomlNode::Type::string)
        return toml_string(node.text);
    if (node.type == TomlNode::Type::integer)
        return fmt::format("{}", node.integer);
    if (node.type == TomlNode::Type::real)
        return fmt::format("{}", node.real);
    return std::array{
        "", "", "", "a boolean", "a date or time", "a list", "a table"}[static_cast<std::size_t>(node.type)];
}

namespace {

constexpr std::size_t kLargestMended = std::size_t{1} << 20; // bytes

void refuse_text(std::string_view text, const std::string& source) {
    if (text.size() > kLargestToml)
        fail(source, {}, "it is no scene or study: it has more than {} bytes", kLargestToml);
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF") ||
        (text.size() > 3 && ((text[1] == '\0' && text[3] == '\0') || (text[0] == '\0' && text[2] == '\0'))))
        fail(source, {1, 1}, "the text is UTF-16; save it as UTF-8");
    if (const std::size_t zero = text.find('\0'); zero != text.npos)
        fail(source, location_in(text, zero), "a byte of value 0: this is no text file, or a damaged one");
    if (text.find('\r') != text.npos && text.find('\n') == text.npos)
        fail(source, {1, 1}, "lines end in a carriage return alone; save the file with line ends of Unix or Windows");
    refuse_deep_keys(text, source);
}

// The byte that a location names.
std::size_t place_of(std::string_view text, const toml::source_position& where) {
    std::size_t at = 0;
    for (std::uint32_t line = 1; line < where.line && at < text.size(); ++line)
        at = std::min(text.find('\n', at), text.size() - 1) + 1;
    for (std::uint32_t column = 1; column < where.column && at < text.size() && text[at] != '\n'; ++column)
        for (++at; at < text.size() && (static_cast<unsigned char>(text[at]) & 0xC0) == 0x80;)
            ++at;
    return at;
}

bool is_toml(const std::string& text) {
    try {
        refuse_deep_keys(text, "");
        static_cast<void>(toml::parse(text));
        return true;
    } catch (const FileError&) {
        return false;
    } catch (const toml::parse_error&) {
        return false;
    }
}

} // namespace

TomlNode parse_toml(std::string_view text, const std::string& source) {
    refuse_text(text, source);
    try {
        return convert(toml::parse(text, std::string_view(source)), source, 0);
    } catch (const toml::parse_error& error) {
        fail(source, location(error.source().begin), std::string(error.description()));
    }
}

MendedToml read_toml(std::string_view text, const std::string& source, Errors& errors) {
    MendedToml result;
    std::string mended(text);
    for (std::size_t tries = 0; tries < kMostErrors; ++tries) {
        try {
            if (!errors.attempt([&] { refuse_text(mended, source); }))
                break;
            result.root = convert(toml::parse(mended, std::string_view(source)), source, 0);
            return result;
        } catch (const FileError& error) {
            errors.add(error);
            break;
        } catch (const toml::parse_error& error) {
            if (text.size() > kLargestMended) {
                errors.add(FileError({{location(error.source().begin), source, std::string(error.description())}}));
                break;
            }
            const TomlMend mend =
                mend_toml(mended, place_of(mended, error.source().begin), error.description(), is_toml);
            errors.add(FileError({{location_in(mended, mend.at), source, mend.message}}));
            if (mended.substr(mend.begin, mend.end - mend.begin) == mend.text)
                break;
            mended.replace(mend.begin, mend.end - mend.begin, mend.text);
            result.whole = result.whole && !mend.left_out;
        }
    }
    return {{}, false};
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
