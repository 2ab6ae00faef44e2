// Text made fit to print: one line of valid UTF-8, broken where it must be.
#include "host/picture/canvas.h"

#include <cstddef>

namespace forceshade::picture {
namespace {

constexpr std::string_view kReplacement = "\xEF\xBF\xBD"; // U+FFFD

bool breaks_after(char c) {
    return c == ' ' || c == '_' || c == '-' || c == '/';
}

// How many bytes of `text` go on a line of `width`: up to the last allowed break, or else as many characters as fit.
std::size_t line_length(std::string_view text, const TextStyle& style, double width) {
    std::size_t fitting = 0, at_break = 0;
    while (fitting < text.size()) {
        const std::size_t next = fitting + character_length(text.substr(fitting));
        if (fitting > 0 && measure(text.substr(0, next), style).width > width)
            return at_break > 0 ? at_break : fitting;
        fitting = next;
        if (breaks_after(text[fitting - 1]))
            at_break = fitting;
    }
    return fitting;
}

} // namespace

// RFC 3629: no overlong forms, no surrogates.
std::size_t character_length(std::string_view text) {
    const auto byte = [&](std::size_t i) {
        return i < text.size() ? static_cast<unsigned>(static_cast<unsigned char>(text[i])) : 0U;
    };
    const auto continues = [&](std::size_t i) { return (byte(i) & 0xC0U) == 0x80U; };
    const unsigned lead = byte(0);
    if (lead < 0x80)
        return 1;
    if (lead >= 0xC2 && lead <= 0xDF)
        return continues(1) ? 2 : 0;
    if (lead >= 0xE0 && lead <= 0xEF) {
        const bool allowed = !(lead == 0xE0 && byte(1) < 0xA0) && !(lead == 0xED && byte(1) > 0x9F);
        return allowed && continues(1) && continues(2) ? 3 : 0;
    }
    if (lead >= 0xF0 && lead <= 0xF4) {
        const bool allowed = !(lead == 0xF0 && byte(1) < 0x90) && !(lead == 0xF4 && byte(1) > 0x8F);
        return allowed && continues(1) && continues(2) && continues(3) ? 4 : 0;
    }
    return 0;
}

std::string printable(std::string_view text) {
    std::string result;
    while (!text.empty()) {
        const std::size_t length = character_length(text);
        const auto first = static_cast<unsigned char>(text.front());
        if (length == 1 && (first < 0x20 || first == 0x7F))
            result += ' ';
        else if (length == 0)
            result += kReplacement;
        else
            result += text.substr(0, length);
        text.remove_prefix(length == 0 ? 1 : length);
    }
    return result;
}

std::vector<std::string> wrap(std::string_view text, const TextStyle& style, double width) {
    const std::string clean = printable(text);
    std::vector<std::string> lines;
    for (std::string_view rest = clean; !rest.empty();) {
        const std::size_t length = line_length(rest, style, width);
        lines.emplace_back(rest.substr(0, length));
        rest.remove_prefix(length);
    }
    return lines;
}

} // namespace forceshade::picture
