#include "host/scene/toml.h"

#include <algorithm>
#include <array>
#include <regex>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

namespace forceshade {

namespace {

std::vector<FileError::One> sorted(std::vector<FileError::One> all) {
    // At one place in the order in which they were found.
    std::set<FileError::One> seen;
    std::erase_if(all, [&](const FileError::One& one) { return !seen.insert(one).second; });
    std::ranges::stable_sort(all, {}, &FileError::One::where);
    return all;
}

std::string text_of(const std::vector<FileError::One>& all) {
    if (all.size() == 1)
        return location_prefix(all.front().source, all.front().where) + all.front().message;
    std::string text;
    for (std::size_t i = 0; i < std::min(all.size(), kMostErrors); ++i)
        text += location_prefix(all[i].source, all[i].where) + all[i].message + '\n';
    // Those of overrides come first and name what was overridden.
    return text + fmt::format("{}{} errors in {}{}", all.size(), all.size() < kEnoughErrors ? "" : " or more",
                              all.back().source,
                              all.size() > kMostErrors ? fmt::format(", the first {} are listed", kMostErrors) : "");
}

} // namespace

std::string location_prefix(std::string_view source, Location location) {
    return location.line == 0 ? fmt::format("{}: ", source)
                              : fmt::format("{}:{}:{}: ", source, location.line, location.column);
}

FileError::FileError(std::vector<One> all) : UsageError(text_of(sorted(all))), all_(sorted(std::move(all))) {}

void fail(std::string_view source, Location location, const std::string& message) {
    throw FileError({{location, std::string(source), message}});
}

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
            fail(source, location_in(text, at), "unknown key: it has more than {} dots", kMostKeyDots);
        ++at;
    }
}

TomlNode convert(const toml::node& node, const std::string& source, int depth) {
    TomlNode result;
    result.where = location(node.source().begin);
    if (depth > kDeepest)
        fail(source, result.where, "unknown key: its tables or lists are nested more than {} deep", kDeepest);
    if (const auto* table = node.as_table()) {
        for (const auto& [key, value] : *table) {
            TomlNode& member = result.items.emplace_back(convert(value, source, depth + 1));
            member.key = key.str();
            member.key_where = location(key.source().begin);
        }
        std::ranges::sort(result.items, {}, &TomlNode::key_where);
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

const TomlNode* TomlNode::find(std::string_view name) const {
    const auto found = std::ranges::find(items, name, &TomlNode::key);
    return found == items.end() ? nullptr : &*found;
}

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

bool is_toml(const std::string& text) {
    try {
        static_cast<void>(toml::parse(text));
        return true;
    } catch (const toml::parse_error&) {
        return false;
    }
}

/// A common mistake: what stands there as a regular expression, what was meant, and why.
struct Mistake {
    const char* written;
    const char* meant;
    const char* reason;
};
constexpr const char* kHeader = "a table's name stands between brackets";
constexpr const char* kPoint = "a number has digits on both sides of its point";
// In this order, each applied to what those before it leave.
constexpr Mistake kMistakes[] = {
    {"\u201c|\u201d|\u201e|\u2018|\u2019|\u00ab|\u00bb", "\"", "these quotes are not those of a keyboard"},
    {R"re(\s*//.*$)re", "", "a comment begins with #"},
    {R"re(^([^\[]*?)\s*[,;]$)re", "$1", "no comma or semicolon ends a line"},
    {R"re(^(?=\[|.*[\]:]$)\[*(variant|experiment\.answer)[\]:]*$)re", "[[$1]]", kHeader},
    {R"re(^(?=\[|.*[\]:]$)\[*([A-Za-z0-9_.-]+)[\]:]*$)re", "[$1]", kHeader},
    {R"re(^(?!\d)([A-Za-z0-9_.-]+)(\s*:\s*|\s+)(?=[^\s=:]))re", "$1 = ", "\"=\" stands between a key and its value"},
    {R"re(^([^\[\{"']*=\s*)(\d+),(\d+))re", "$1$2.$3", "a number has a decimal point"},
    {R"re(([=\[,]\s*)\.(?=\d+\s*(?:$|[,\]}])))re", "$010.", kPoint},
    {R"re(([=\[,]\s*\d+\.)(?=\s*(?:$|[,\]}])))re", "$010", kPoint},
    {R"re("([^"]*\\[^"]*)")re", "'$1'", "a backslash means something else between double quotes"},
    {R"re("([^"]*)"\s*([^\s"',\]}=][^"',\]}=]*?)(?=\s*(?:$|[,\]}])))re", "\"$1 $2\"",
     "number and unit stand in quotes together"},
    {R"re((^|[=\[,]\s*)(?!(?:[-+.0-9_e]+|true|false)\s*(?:$|[,\]}])))re"
     R"re(([^\s"'\[\]{},=][^"'\[\]{},=]*?)(?=\s*(?:$|[,\]}])))re",
     "$1\"$2\"", "quotes are missing"},
    {R"re(^((?:[^"]|"[^"]*")*"[^"]*)$)re", "$1\"", "a quote is not closed"},
    {R"re(^(.*\[[^\]]*)$)re", "$1]", "a bracket is not closed"}};

// A line without its comment and the blanks around.
std::string code_of(std::string_view line) {
    for (std::size_t at = 0; at < line.size(); ++at) {
        if (line[at] == '"' || line[at] == '\'')
            at = end_of_quoted(line, at) - 1;
        else if (line[at] == '#')
            line = line.substr(0, at);
    }
    const std::size_t begin = std::min(line.find_first_not_of(" \t\r"), line.size());
    return std::string(line.substr(begin, line.find_last_not_of(" \t\r") + 1 - begin));
}

// "quotes are missing; write radius = \"600 mil\""; empty: it is none of the common mistakes.
std::string correction(const std::string& code, bool in_list) {
    constexpr std::size_t kLongest = 200; // std::regex recurses once a character
    if (code.size() > kLongest)
        return "";
    static const std::vector<std::regex> written = [] {
        std::vector<std::regex> all;
        for (const Mistake& mistake : kMistakes)
            all.emplace_back(mistake.written);
        return all;
    }();
    std::string meant = code;
    std::vector<std::string_view> reasons;
    for (std::size_t i = 0; i < written.size(); ++i) {
        std::string better = std::regex_replace(meant, written[i], kMistakes[i].meant);
        if (better == meant)
            continue;
        meant = std::move(better);
        if (reasons.empty() || reasons.back() != kMistakes[i].reason)
            reasons.emplace_back(kMistakes[i].reason);
        // The list may have begun on a line above or go on below.
        if (is_toml(meant) ||
            (in_list && (is_toml(meant + ']') || is_toml("x = [" + meant) || is_toml("x = [" + meant + ']'))))
            return fmt::format("{}; write {}", fmt::join(reasons, "; "), meant);
    }
    return "";
}

// What the parser says, in words that say what to write instead where the mistake is a common one.
[[noreturn]] void refuse_syntax(std::string_view text, const std::string& source, const toml::parse_error& error) {
    std::string_view message = error.description();
    Location where = location(error.source().begin);
    const auto says = [&](std::string_view words) { return message.find(words) != message.npos; };
    if (says("utf-8") || says("UTF-8"))
        fail(source, where, "this is no UTF-8; save the file as UTF-8 (and \"um\" may stand for micrometres)");
    std::vector<std::string_view> lines{""};
    for (std::size_t at = 0; at <= text.size() && lines.size() <= where.line; at += lines.back().size() + 1)
        lines.push_back(text.substr(at, text.find('\n', at) - at));
    std::string code = code_of(lines.back());
    const std::string key = code.substr(0, code.find_last_not_of(" \t", code.find('=') - 1) + 1);
    if (says("redefine"))
        code.starts_with('[') ? fail(source, where, "{} is there twice; write the keys of both under one", code)
                              : fail(source, where, "\"{}\" is given twice here; leave one", key);
    if (code.ends_with('='))
        fail(source, where, "{} has no value; forceshade schema says what it may be", key);
    if (code.starts_with('{'))
        fail(source, where,
             "this may be JSON; a scene is TOML: [surface] on a line, and below it radius = \"600 mil\"");
    const bool in_list = says("parsing array");
    // A list that is not closed is found out on the next line.
    if (in_list && where.column == 1 && lines.size() > 2) {
        do {
            lines.pop_back();
            code = code_of(lines.back());
        } while (code.empty() && lines.size() > 2);
        where = location_in(text, static_cast<std::size_t>(lines.back().data() + lines.back().size() - text.data()));
    }
    if (const std::string correct = correction(code, in_list); !correct.empty())
        fail(source, where, correct);
    constexpr std::string_view kWhile = "Error while parsing ";
    if (!message.starts_with(kWhile))
        fail(source, where, "this is no TOML: {}", message);
    message.remove_prefix(kWhile.size());
    const std::size_t colon = std::min(message.find(": "), message.size() - 2);
    fail(source, where, "this is no TOML ({}): {}", message.substr(0, colon), message.substr(colon + 2));
}

} // namespace

TomlNode parse_toml(std::string_view text, const std::string& source) {
    refuse_text(text, source);
    try {
        return convert(toml::parse(text, std::string_view(source)), source, 0);
    } catch (const toml::parse_error& error) {
        refuse_syntax(text, source, error);
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
