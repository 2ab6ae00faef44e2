#include "device/report/wrapped_lines.h"

#include <fmt/format.h>

#include "host/picture/canvas.h"

namespace forceshade::device {
namespace {

constexpr std::size_t kIndent = 14; // columns

bool begins_character(char byte) {
    return (static_cast<unsigned char>(byte) & 0xC0U) != 0x80U;
}

// What goes on a line, at most `columns` > 0 wide; `rest` loses it and the space behind.
std::string_view take_line(std::string_view& rest, std::size_t columns) {
    std::string_view line = cut_to_columns(rest, columns);
    if (line.size() < rest.size() && rest[line.size()] != ' ')
        if (const std::size_t space = line.rfind(' '); space != std::string_view::npos && space > 0)
            line = line.substr(0, space);
    rest.remove_prefix(line.size());
    while (rest.starts_with(' '))
        rest.remove_prefix(1);
    return line;
}

} // namespace

std::size_t columns_of(std::string_view text) {
    std::size_t columns = 0;
    for (const char byte : text)
        columns += begins_character(byte);
    return columns;
}

std::string_view cut_to_columns(std::string_view text, std::size_t columns) {
    std::size_t end = 0, seen = 0;
    while (end < text.size() && (seen += begins_character(text[end])) <= columns)
        ++end;
    return text.substr(0, end);
}

void WrappedLines::add(std::string_view label, std::string_view text) {
    const std::string clean = picture::printable(text);
    std::string_view rest = clean;
    do {
        const std::string_view line = take_line(rest, kColumns - kIndent);
        text_ += fmt::format("{:<{}}{}\n", label, kIndent, line);
        label = "";
    } while (!rest.empty());
}

void WrappedLines::add_line(std::string_view line) {
    text_ += line.substr(0, line.find_last_not_of(' ') + 1);
    text_ += '\n';
}

} // namespace forceshade::device
