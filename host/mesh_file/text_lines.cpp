#include "host/mesh_file/text_lines.h"

#include <charconv>
#include <utility>

#include <fmt/format.h>
#include <locale.h>
#include <stdlib.h>

#include "host/error.h"

namespace forceshade::mesh_file {
namespace {

bool is_blank(char c) {
    return c == ' ' || c == '\t' || c == '\v' || c == '\f';
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

TextLines::TextLines(std::string file, std::string_view text) : file_(std::move(file)), text_(text) {
    if (text_.starts_with("\xEF\xBB\xBF"))
        text_.remove_prefix(3);
}

bool TextLines::next(std::string_view& line) {
    if (text_.empty())
        return false;
    ++number_;
    const std::size_t end = text_.find_first_of("\n\r");
    line = text_.substr(0, end);
    if (end == std::string_view::npos) {
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
        while (!line.empty() && is_blank(line.front()))
            line.remove_prefix(1);
        if (!line.empty())
            return true;
    }
    return false;
}

void TextLines::damaged(std::string_view message) const {
    throw IoError(fmt::format("{}:{}: {}", file_, number_, message));
}

std::string_view take_word(std::string_view& line) {
    std::size_t begin = 0;
    while (begin < line.size() && is_blank(line[begin]))
        ++begin;
    std::size_t end = begin;
    while (end < line.size() && !is_blank(line[end]))
        ++end;
    const std::string_view word = line.substr(begin, end - begin);
    line.remove_prefix(end);
    return word;
}

std::string quoted(std::string_view word) {
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

} // namespace forceshade::mesh_file
