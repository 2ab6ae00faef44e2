// Shared by the readers of text: lines, words and numbers, and the count of skipped elements.
#include <algorithm>
#include <charconv>
#include <string>
#include <utility>

#include <locale.h>
#include <stdlib.h>

#include "host/mesh/formats.h"

namespace forceshade::mesh_file {

namespace {

// Lines and words are short, and searching through them for one of several characters with string_view's functions
// takes several times as long.
bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
}

void skip_blanks(std::string_view& line) {
    line.remove_prefix(static_cast<std::size_t>(std::ranges::find_if_not(line, is_blank) - line.begin()));
}

// std::from_chars leaves the value alone where it is beyond the range of double, on either side.
double beyond_range(std::string_view word) {
    static const locale_t classic = ::newlocale(LC_ALL_MASK, "C", nullptr);
    return ::strtod_l(std::string(word).c_str(), nullptr, classic);
}

std::string_view without_plus(std::string_view word) {
    if (word.size() > 1 && word[0] == '+' && word[1] != '-')
        word.remove_prefix(1);
    return word;
}

} // namespace

TextLines::TextLines(std::string file, std::string_view text, std::size_t number)
    : file_(std::move(file)), text_(text), number_(number) {}

bool TextLines::next(std::string_view& line) {
    if (text_.empty())
        return false;
    ++number_;
    const auto end = static_cast<std::size_t>(
        std::ranges::find_if(text_, [](char c) { return c == '\n' || c == '\r'; }) - text_.begin());
    line = text_.substr(0, end);
    if (line.starts_with("\xEF\xBB\xBF")) // not only in the first: files are joined as they are
        line.remove_prefix(3);
    has_end_ = end < text_.size();
    if (!has_end_) {
        text_ = {};
        return true;
    }
    const bool two = text_[end] == '\r' && end + 1 < text_.size() && text_[end + 1] == '\n';
    text_.remove_prefix(end + (two ? 2 : 1));
    return true;
}

bool TextLines::next_words(std::string_view& line) {
    while (next(line)) {
        line = line.substr(0, line.find('#'));
        skip_blanks(line);
        if (!line.empty())
            return true;
    }
    return false;
}

std::string_view take_word(std::string_view& line) {
    skip_blanks(line);
    const auto end = static_cast<std::size_t>(std::ranges::find_if(line, is_blank) - line.begin());
    const std::string_view word = line.substr(0, end);
    line.remove_prefix(end);
    return word;
}

std::string in_quotes(std::string_view word) {
    constexpr std::size_t kMost = 24;
    std::string text = "\"";
    for (const char c : word.substr(0, kMost))
        text += c < ' ' || c == '\x7F' ? '?' : c; // bytes beyond ASCII are negative: shown as ? too
    return text + (word.size() > kMost ? "...\"" : "\"");
}

bool parse_number(std::string_view word, double& value) {
    word = without_plus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (end != word.data() + word.size() || error == std::errc::invalid_argument)
        return false;
    if (error == std::errc::result_out_of_range)
        value = beyond_range(word);
    return true;
}

bool parse_integer(std::string_view word, std::int64_t& value) {
    word = without_plus(word);
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    return error == std::errc() && end == word.data() + word.size();
}

bool has_only_numbers(std::string_view line) {
    std::string_view word = take_word(line);
    if (word.empty())
        return false;
    double value = 0;
    for (; !word.empty(); word = take_word(line))
        if (!parse_number(word, value) && word.find_first_not_of("/-0123456789") != std::string_view::npos)
            return false;
    return true;
}

bool looks_like_text(std::string_view bytes) {
    constexpr std::size_t kLooked = 1024;
    return bytes.substr(0, kLooked).find('\0') == std::string_view::npos;
}

bool is_keyword(std::string_view word, std::string_view keyword) {
    return std::ranges::equal(word, keyword,
                              [](char a, char b) { return (a >= 'A' && a <= 'Z' ? a - 'A' + 'a' : a) == b; });
}

void Skipped::add(const Kind& kind, std::size_t place) {
    const auto known = std::ranges::find(entries_, kind.one, [](const Entry& entry) { return entry.kind.one; });
    if (known == entries_.end())
        entries_.push_back({kind, 1, place});
    else
        ++known->count;
}

std::vector<std::string> Skipped::warnings() const {
    std::vector<std::string> warnings;
    for (const auto& [kind, count, first] : entries_)
        warnings.push_back(fmt::format("{} {}: skipped ({}{} {})", count, count == 1 ? kind.one : kind.several,
                                       count == 1 ? "" : "the first ", where_, first));
    return warnings;
}

} // namespace forceshade::mesh_file
