// Parts of a text: what is between blanks and marks, and the number that it is, independent of the locale.
#pragma once

#include <charconv>
#include <cmath>
#include <optional>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>
#include <vector>

namespace forceshade {

/// The finite number that a text is, and nothing else; none where it is no number, or one beyond T.
template <typename T> std::optional<T> number_in(std::string_view text) {
    T number{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if constexpr (std::is_floating_point_v<T>)
        if (!std::isfinite(number))
            return std::nullopt;
    return error == std::errc() && end == text.data() + text.size() ? std::optional(number) : std::nullopt;
}

/// The same from `least` to `most`.
template <typename T> std::optional<T> number_in(std::string_view text, T least, T most) {
    const std::optional<T> number = number_in<T>(text);
    return number && *number >= least && *number <= most ? number : std::nullopt;
}

/// Without blanks, tabs and carriage returns at its ends.
inline std::string_view trimmed(std::string_view text) {
    const std::size_t begin = text.find_first_not_of(" \t\r");
    return begin == text.npos ? text.substr(0, 0) : text.substr(begin, text.find_last_not_of(" \t\r") - begin + 1);
}

/// The parts between marks, at least one.
inline std::vector<std::string> split(std::string_view text, char mark) {
    std::vector<std::string> parts;
    for (std::size_t begin = 0; begin <= text.size(); begin += parts.back().size() + 1)
        parts.emplace_back(text.substr(begin, text.find(mark, begin) - begin));
    return parts;
}

} // namespace forceshade
