#include "host/scene/toml_mend.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade {

namespace {

using Parses = std::function<bool(const std::string&)>;

constexpr std::size_t kLongestMended = 4000; // bytes of a statement
constexpr std::size_t kLongestShown = 100;

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\r' || c == '\n';
}

std::string_view trim(std::string_view text) {
    while (!text.empty() && is_blank(text.front()))
        text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back()))
        text.remove_suffix(1);
    return text;
}

bool is_key_char(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-' ||
           c == '.';
}

// Behind a key at the beginning of a line; 0 if there is none.
std::size_t end_of_key(std::string_view line) {
    const auto skip_blanks = [&](std::size_t i) { return std::min(line.find_first_not_of(" \t", i), line.size()); };
    const std::size_t begin = skip_blanks(0);
    std::size_t end = begin;
    while (end < line.size() && is_key_char(line[end]))
        ++end;
    return end == begin ? 0 : end;
}

// `key =` or `[table]`: a line that goes on with no statement before it.
bool begins_statement(std::string_view line) {
    if (const std::size_t key = end_of_key(line)) {
        const std::size_t next = line.find_first_not_of(" \t", key);
        return next != line.npos && line[next] == '=';
    }
    std::string_view header = trim(line);
    if (header.substr(0, 1) != "[")
        return false;
    header.remove_prefix(header.starts_with("[[") ? 2 : 1);
    const std::size_t name = end_of_key(header);
    return name > 0 && !(header[0] >= '0' && header[0] <= '9') && header.substr(name).starts_with("]");
}

struct Statement {
    std::size_t begin = 0, end = 0; // end: its line's end
    bool open = false;              // a quote or bracket of it is not closed
};

// The statement that begins at a line's beginning.
Statement statement_at(std::string_view text, std::size_t begin) {
    Statement result{begin, begin, false};
    int depth = 0;
    for (std::size_t at = begin; at < text.size();) {
        const char c = text[at];
        if (c == '\n') {
            result.end = at;
            const std::string_view next = text.substr(at + 1, text.find('\n', at + 1) - at - 1);
            if (depth <= 0 || begins_statement(next)) {
                result.open = result.open || depth > 0;
                return result;
            }
        }
        if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
            continue;
        }
        if (c == '"' || c == '\'') {
            const std::size_t end = end_of_quoted(text, at);
            const std::size_t width = text.substr(at, 3) == std::string(3, c) ? 3 : 1;
            const bool closed = end >= at + 2 * width && text[end - 1] == c;
            result.open = result.open || !closed;
            at = std::max(end, at + 1);
            continue;
        }
        depth += (c == '[' || c == '{') - (c == ']' || c == '}');
        ++at;
    }
    result.end = text.size();
    result.open = result.open || depth > 0;
    return result;
}

// The first that is open up to `at`, or the one that holds it.
Statement culprit(std::string_view text, std::size_t at) {
    for (std::size_t begin = 0;;) {
        const Statement one = statement_at(text, begin);
        if (one.open || one.end >= at || one.end + 1 >= text.size())
            return one;
        begin = one.end + 1;
    }
}

/// A statement on its way to what was meant, and why.
struct Attempt {
    std::string text;
    std::vector<std::string> reasons;

    void because(const char* reason) {
        if (std::ranges::find(reasons, reason) == reasons.end())
            reasons.emplace_back(reason);
    }
};

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = text.find(from); at != text.npos; at = text.find(from, at + to.size()))
        text.replace(at, from.size(), to);
}

// Quotes that a word processor made.
void plain_quotes(Attempt& attempt) {
    const std::string before = attempt.text;
    for (const char* quote : {"\u201c", "\u201d", "\u201e", "\u2018", "\u2019", "\u00ab", "\u00bb"})
        replace_all(attempt.text, quote, "\"");
    if (attempt.text != before)
        attempt.because("these quotes are not those of a keyboard");
}

// Where the comment of a line begins, or its end.
std::size_t comment_of(std::string_view line, std::string_view mark) {
    for (std::size_t at = 0; at < line.size();) {
        if (line[at] == '"' || line[at] == '\'')
            at = std::max(at + 1, end_of_quoted(line, at));
        else if (line.substr(at).starts_with(mark))
            return at;
        else
            ++at;
    }
    return line.size();
}

// The text of a single line, apart from its comment and the blanks before that.
std::string_view code_of(std::string_view line) {
    std::string_view code = line.substr(0, comment_of(line, "#"));
    while (!code.empty() && is_blank(code.back()))
        code.remove_suffix(1);
    return code;
}

// Comments and line ends as other languages have them.
void plain_ends(Attempt& attempt) {
    if (attempt.text.find('\n') != std::string::npos)
        return;
    if (const std::size_t slashes = comment_of(code_of(attempt.text), "//"); slashes < code_of(attempt.text).size()) {
        attempt.text.replace(slashes, 2, "#");
        attempt.because("a comment begins with #");
    }
    const std::string_view code = code_of(attempt.text);
    if (code.ends_with(',') || code.ends_with(';')) {
        attempt.text.erase(code.size() - 1, 1);
        attempt.because("no comma or semicolon ends a line");
    }
}

// `[surface` or `surface]`: true if it is a table's header.
bool close_header(Attempt& attempt) {
    const std::string_view code = trim(code_of(attempt.text));
    if (code.find('=') != code.npos || code.find('"') != code.npos ||
        !(code.starts_with('[') || code.ends_with(']') || code.ends_with(':')))
        return false;
    const std::size_t begin = std::min(code.find_first_not_of("[{( \t"), code.size());
    const std::string_view name = code.substr(begin, end_of_key(code.substr(begin)));
    if (name.empty())
        return false;
    const bool list = name == "variant" || name == "experiment.answer";
    const std::string whole = list ? fmt::format("[[{}]]", name) : fmt::format("[{}]", name);
    const auto at = static_cast<std::size_t>(code.data() - attempt.text.data());
    if (code != whole)
        attempt.because("a table's name stands between brackets");
    attempt.text.replace(at, code.size(), whole);
    return true;
}

// `key: value` or `key value`.
void add_equals(Attempt& attempt) {
    const std::size_t key = end_of_key(attempt.text);
    if (key == 0)
        return;
    const std::size_t next = std::min(attempt.text.find_first_not_of(" \t", key), attempt.text.size());
    if (next == attempt.text.size() || attempt.text[next] == '=')
        return;
    attempt.because("\"=\" stands between a key and its value");
    if (attempt.text[next] == ':')
        attempt.text.replace(key, next + 1 - key, " =");
    else if (next > key)
        attempt.text.insert(key, " =");
}

// A number as TOML writes it, where somebody wrote ".5" or "5."; of a lonely "0,5", too.
std::optional<std::string> plain_number(std::string_view text, bool alone) {
    if (text.find_first_of(".,") == text.npos)
        return std::nullopt;
    std::string point(text);
    if (alone)
        std::ranges::replace(point, ',', '.');
    const std::string_view digits = std::string_view(point).substr(point.starts_with('+') ? 1 : 0);
    double number = 0;
    const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
    if (digits.empty() || error != std::errc() || end != digits.data() + digits.size() || !std::isfinite(number))
        return std::nullopt;
    return fmt::format("{}", number);
}

/// Puts values in quotes that need them.
class Quoter {
public:
    Quoter(std::string_view value, const Parses& parses) : value_(value), parses_(parses) {}

    std::string quoted(Attempt& attempt) {
        for (std::size_t at = 0; at < value_.size();) {
            const char c = value_[at];
            if (is_separator(c) || is_blank(c)) {
                depth_ += (c == '[' || c == '{') - (c == ']' || c == '}');
                result_ += c;
                ++at;
            } else if (c == '#') {
                const std::size_t end = std::min(value_.find('\n', at), value_.size());
                result_ += value_.substr(at, end - at);
                at = end;
            } else {
                at = take(at, attempt);
            }
        }
        return std::move(result_);
    }

private:
    // A comma outside of brackets is somebody's decimal point.
    bool is_separator(char c) const {
        return c == '[' || c == ']' || c == '{' || c == '}' || c == '=' || (c == ',' && depth_ > 0);
    }

    // One value, from here to the next separator, line or comment.
    std::size_t take(std::size_t begin, Attempt& attempt) {
        std::size_t at = begin, quotes = 0;
        while (at < value_.size() && !is_separator(value_[at]) && value_[at] != '\n' && value_[at] != '#') {
            const bool quote = value_[at] == '"' || value_[at] == '\'';
            quotes += quote ? 1 : 0;
            at = quote ? std::max(at + 1, end_of_quoted(value_, at)) : at + 1;
        }
        const std::string_view text = trim(value_.substr(begin, at - begin));
        const bool is_key = at < value_.size() && value_[at] == '=';
        const bool is_integer = text.find_first_not_of("+-_0123456789") == text.npos; // if need be too large a one
        if (is_key || is_integer || parses_(fmt::format("x = {}", text))) {
            result_ += text;
        } else if (const auto number = plain_number(text, depth_ == 0)) {
            attempt.because(text.find(',') == text.npos ? "a number has digits on both sides of its point"
                                                        : "a number has a decimal point");
            result_ += *number;
        } else {
            quote(text, quotes, attempt);
        }
        return begin + static_cast<std::size_t>(text.data() + text.size() - (value_.data() + begin));
    }

    void quote(std::string_view text, std::size_t quotes, Attempt& attempt) {
        if (quotes == 1 && text.front() == '"' && text.find('\\') != text.npos && text.find('\'') == text.npos) {
            attempt.because("a backslash means something else between double quotes");
            std::string plain(text);
            std::ranges::replace(plain, '"', '\'');
            result_ += plain;
            return;
        }
        std::string inner(text);
        std::erase_if(inner, [](char c) { return c == '"' || c == '\''; });
        if (quotes == 1 && std::ranges::count(text, text.front()) == 1)
            attempt.because("a quote is not closed");
        else if (quotes == 0)
            attempt.because("quotes are missing");
        else
            attempt.because("number and unit stand in quotes together");
        if (quotes == 0 && depth_ == 0 && inner.find(',') != inner.npos && inner.find_first_of("0123456789") == 0)
            attempt.because("a number has a decimal point"), std::ranges::replace(inner, ',', '.');
        result_ += fmt::format("\"{}\"", trim(inner));
    }

    std::string_view value_;
    const Parses& parses_;
    std::string result_;
    int depth_ = 0;
};

// Where there is `key = value`.
void quote_values(Attempt& attempt, const Parses& parses) {
    const std::size_t equals = attempt.text.find('=');
    if (equals == attempt.text.npos)
        return;
    const std::string value = attempt.text.substr(equals + 1);
    attempt.text = attempt.text.substr(0, equals + 1) + Quoter(value, parses).quoted(attempt);
}

void close_brackets(Attempt& attempt) {
    std::string open;
    std::size_t last = 0; // behind the last character that is no comment
    for (std::size_t at = 0; at < attempt.text.size();) {
        const char c = attempt.text[at];
        if (c == '#') {
            at = std::min(attempt.text.find('\n', at), attempt.text.size());
            continue;
        }
        if (c == '"' || c == '\'') {
            last = at = std::max(at + 1, end_of_quoted(attempt.text, at));
            continue;
        }
        if (c == '[' || c == '{')
            open += c == '[' ? ']' : '}';
        if (!open.empty() && c == open.back())
            open.pop_back();
        ++at;
        if (!is_blank(c))
            last = at;
    }
    if (open.empty())
        return;
    attempt.because("a bracket is not closed");
    std::ranges::reverse(open);
    attempt.text.insert(last, open);
}

// As it was meant, or nothing.
std::optional<Attempt> mended(std::string_view statement, const Parses& parses) {
    if (statement.size() > kLongestMended)
        return std::nullopt;
    Attempt attempt{std::string(statement), {}};
    const auto works = [&] { return !attempt.reasons.empty() && parses(attempt.text); };
    plain_quotes(attempt);
    plain_ends(attempt);
    if (works())
        return attempt;
    if (close_header(attempt))
        return works() ? std::optional(attempt) : std::nullopt;
    add_equals(attempt);
    if (works())
        return attempt;
    quote_values(attempt, parses);
    if (works())
        return attempt;
    close_brackets(attempt);
    return works() ? std::optional(attempt) : std::nullopt;
}

// A statement without its comments, on one line.
std::string shown(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find('\n'), text.size());
        const std::string_view code = trim(code_of(text.substr(0, end)));
        result += fmt::format("{}{}", result.empty() || code.empty() ? "" : " ", code);
        text.remove_prefix(std::min(end + 1, text.size()));
    }
    return result.size() > kLongestShown ? result.substr(0, result.find_last_of(" ,", kLongestShown)) + " ..." : result;
}

std::string blank(std::string_view text) {
    std::string result;
    for (const char c : text)
        result += c == '\n' ? "\n" : "";
    return result;
}

// The parser's words in those of the others; what to do about what it cannot name.
std::string plain_complaint(std::string_view complaint, std::string_view statement) {
    if (complaint.find("utf-8") != complaint.npos || complaint.find("UTF-8") != complaint.npos)
        return "this is no UTF-8; save the file as UTF-8 (and \"um\" may stand for micrometres)";
    if (trim(statement).starts_with('{'))
        return "this may be JSON; a scene is TOML: [surface] on a line, and below it radius = \"600 mil\"";
    const std::string_view key = trim(statement.substr(0, statement.find('=')));
    if (trim(statement.substr(key.size())) == "=" || trim(code_of(statement)).ends_with('='))
        return fmt::format("{} has no value; forceshade schema says what it may be", trim(key));
    constexpr std::string_view kWhile = "Error while parsing ";
    if (complaint.starts_with(kWhile)) {
        const std::size_t colon = complaint.find(": ");
        return fmt::format("this is no TOML ({}): {}", complaint.substr(kWhile.size(), colon - kWhile.size()),
                           complaint.substr(std::min(colon + 2, complaint.size())));
    }
    return fmt::format("this is no TOML: {}", complaint);
}

// A table or key that stands there twice. A table's second part is left out as far as its keys go.
TomlMend mend_repetition(std::string_view text, const Statement& statement, std::size_t at) {
    TomlMend mend{statement.begin, statement.end, at, {}, {}, false};
    const std::string_view code = trim(code_of(text.substr(statement.begin, statement.end - statement.begin)));
    if (!code.starts_with('[')) {
        mend.message = fmt::format("\"{}\" is given twice here; leave one", trim(code.substr(0, code.find('='))));
    } else {
        mend.message = fmt::format("{} is there twice; write the keys of both under one", code);
        mend.left_out = true;
        while (mend.end < text.size()) {
            const std::size_t end = std::min(text.find('\n', mend.end + 1), text.size());
            const std::string_view line = text.substr(mend.end + 1, end - mend.end - 1);
            if (trim(line).starts_with('[') && begins_statement(line))
                break;
            mend.end = end;
        }
    }
    mend.text = blank(text.substr(mend.begin, mend.end - mend.begin));
    return mend;
}

} // namespace

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

TomlMend mend_toml(std::string_view text, std::size_t at, std::string_view complaint, const Parses& parses) {
    Statement statement = culprit(text, at);
    statement.end -= text.substr(statement.begin, statement.end - statement.begin).ends_with('\r') ? 1 : 0;
    const std::string_view written = text.substr(statement.begin, statement.end - statement.begin);
    if (complaint.find("redefine") != complaint.npos)
        return mend_repetition(text, statement, at);
    TomlMend mend{statement.begin, statement.end, at, {}, {}, false};
    if (const auto attempt = mended(written, parses)) {
        const auto differs = std::ranges::mismatch(written, attempt->text).in1;
        mend.at = statement.begin + static_cast<std::size_t>(differs - written.begin());
        mend.message = fmt::format("{}; write {}", fmt::join(attempt->reasons, "; "), shown(attempt->text));
        mend.text = attempt->text;
        return mend;
    }
    mend.at = std::clamp(at, statement.begin, statement.end);
    mend.message = plain_complaint(complaint, written);
    mend.text = blank(written);
    mend.left_out = true;
    return mend;
}

} // namespace forceshade
