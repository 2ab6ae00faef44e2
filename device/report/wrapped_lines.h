// Lines of a label and a text, broken at a width that any terminal has.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace forceshade::device {

inline constexpr std::size_t kColumns = 100;

/// How many columns UTF-8 text takes, a character each.
std::size_t columns_of(std::string_view text);

/// No more than so many columns of it.
std::string_view cut_to_columns(std::string_view text, std::size_t columns);

class WrappedLines {
public:
    /// `label` in the first columns of the first line, the text beside it, broken at spaces, or anywhere if it must be.
    /// What a terminal would not print is replaced.
    void add(std::string_view label, std::string_view text);
    /// A line as it is.
    void add_line(std::string_view line);

    const std::string& text() const noexcept { return text_; }

private:
    std::string text_;
};

} // namespace forceshade::device
