#include "host/plot/text_size.h"

#include <cstdint>

namespace forceshade::plot {
namespace {

bool continues(char c) {
    return (static_cast<std::uint8_t>(c) & 0xC0u) == 0x80u;
}

// em
double advance(char c) {
    const auto among = [c](std::string_view set) { return set.find(c) != std::string_view::npos; };
    if (static_cast<std::uint8_t>(c) >= 0xE3) // East Asian and symbols beyond
        return 1.0;
    if (static_cast<std::uint8_t>(c) >= 0x80)
        return 0.68;
    if (among("ijlI'|"))
        return 0.32;
    if (among(" .,:;!/\\()[]ft-`r"))
        return 0.42;
    if (among("mMWw%@"))
        return 0.95;
    if (c >= 'A' && c <= 'Z')
        return 0.74;
    if (among("+=<>~#_^"))
        return 0.84;
    return 0.636;
}

} // namespace

double text_width(std::string_view text, double font_size) {
    double sum = 0;
    for (const char c : text)
        if (!continues(c))
            sum += advance(c);
    return sum * font_size;
}

std::vector<std::string> wrapped(std::string_view text, double font_size, double width) {
    std::vector<std::string> lines(1);
    while (!text.empty()) {
        const std::size_t space = text.find(' ');
        const std::string_view word = text.substr(0, space);
        const std::string longer = lines.back().empty() ? std::string(word) : lines.back() + " " + std::string(word);
        if (!lines.back().empty() && text_width(longer, font_size) > width)
            lines.emplace_back(word);
        else
            lines.back() = longer;
        text.remove_prefix(space == std::string_view::npos ? text.size() : space + 1);
    }
    return lines;
}

std::string shortened(std::string_view text, double font_size, double width) {
    if (text_width(text, font_size) <= width)
        return std::string(text);
    std::string kept;
    for (std::size_t i = 0; i < text.size();) {
        std::size_t end = i + 1;
        while (end < text.size() && continues(text[end]))
            ++end;
        const std::string longer = kept + std::string(text.substr(i, end - i));
        if (text_width(longer + "…", font_size) > width)
            break;
        kept = longer;
        i = end;
    }
    return kept + "…";
}

} // namespace forceshade::plot
