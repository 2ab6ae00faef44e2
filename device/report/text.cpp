#include "device/report/text.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numeric>
#include <utility>

#include <fmt/format.h>

#include "host/picture/canvas.h"

namespace forceshade::device {

namespace {

constexpr std::array<std::string_view, 17> kPrefixes{"y", "z", "a", "f", "p", "n", "u", "m", "",
                                                     "k", "M", "G", "T", "P", "E", "Z", "Y"};
constexpr int kUnity = 8; // the prefix of 1

// Three digits and the exponent of the first: 1, 2, 3 and -4 of 1.23e-4.
struct Digits {
    std::string text;
    int exponent = 0;
};

Digits digits_of(double value) {
    const std::string text = fmt::format("{:.2e}", value); // "1.23e-04"
    Digits digits{{text[0], text[2], text[3]}, 0};
    const char* begin = text.data() + 5;
    std::from_chars(*begin == '+' ? begin + 1 : begin, text.data() + text.size(), digits.exponent);
    return digits;
}

void drop_zeros(std::string& number) {
    if (number.find('.') == std::string::npos)
        return;
    number.erase(number.find_last_not_of('0') + 1);
    if (number.back() == '.')
        number.pop_back();
}

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

constexpr std::size_t kLabel = 19;               // columns, with the gap behind
constexpr std::size_t kCount = 11;               // with the gap before
constexpr std::size_t kRows = 1 + 3 * 20;        // none, and 1, 2, 5 of each power of ten up to 2^64
constexpr std::array<double, 3> kSteps{1, 2, 5}; // ns

// The least time of a row; of the first 0.
double begin_of(std::size_t row) {
    return row == 0 ? 0 : kSteps[(row - 1) % 3] * std::pow(10.0, static_cast<double>((row - 1) / 3));
}

std::size_t row_of(double time) {
    std::size_t row = 0;
    while (row + 1 < kRows && begin_of(row + 1) <= time)
        ++row;
    return row;
}

using Counts = std::array<std::uint64_t, kRows>;

Counts counts_of(const Histogram& times) {
    Counts counts{};
    for (std::size_t bin = 0; bin < Histogram::kBins; ++bin) {
        if (times.bin(bin) == 0)
            continue;
        const std::uint64_t longest = std::min(Histogram::begin_of(bin + 1) - 1, times.largest());
        counts[row_of(static_cast<double>(longest))] += times.bin(bin);
    }
    return counts;
}

std::string label_of(std::size_t row) {
    if (row == 0)
        return "0";
    if (row + 1 == kRows)
        return fmt::format("from {}", time_text(begin_of(row)));
    return fmt::format("{:>6} to {:>6}", time_text(begin_of(row)), time_text(begin_of(row + 1)));
}

std::string bar_of(std::uint64_t count, std::uint64_t most, std::size_t width) {
    if (count == 0)
        return "";
    const double length = static_cast<double>(count) / static_cast<double>(most) * static_cast<double>(width);
    return std::string(std::clamp<std::size_t>(static_cast<std::size_t>(std::lround(length)), 1, width), '#');
}

// Puts the shortest times, at most 1 % of each column, into one row; which one, 0 if there is nothing to gather.
std::size_t gather_shortest(std::vector<Counts>& counts) {
    std::size_t end = 0;
    const auto few = [&](std::size_t row) {
        return std::all_of(counts.begin(), counts.end(), [&](const Counts& one) {
            const auto all = std::accumulate(one.begin(), one.end(), std::uint64_t(0));
            return std::accumulate(one.begin(), one.begin() + static_cast<std::ptrdiff_t>(row) + 1, std::uint64_t(0)) <=
                   all / 100;
        });
    };
    while (end + 1 < kRows && few(end))
        ++end;
    if (end < 2)
        return 0;
    for (Counts& one : counts)
        for (std::size_t row = 0; row + 1 < end; ++row)
            one[end - 1] += std::exchange(one[row], 0);
    return end - 1;
}

} // namespace

std::string quantity(double value, std::string_view base, const NumberStyle& style) {
    if (!std::isfinite(value))
        return "unknown";
    if (value == 0)
        return fmt::format("0 {}", base);
    const char* sign = value >= 0 ? "" : style.micro == "µ" ? "−" : "-";
    const double size = std::fabs(value);
    const Digits digits = digits_of(size);
    const bool metric = base != "s" && !base.starts_with("m");
    const int prefix = kUnity + static_cast<int>(std::floor(digits.exponent / 3.0));
    if (!metric && digits.exponent >= 3 && digits.exponent < 15)
        return fmt::format("{}{:.0f} {}", sign, size, base);
    if (prefix < 0 || prefix >= static_cast<int>(kPrefixes.size()) || (!metric && digits.exponent >= 3))
        return fmt::format("{}{:.2e} {}", sign, size, base);
    std::string number = digits.text;
    const int whole = 1 + digits.exponent - 3 * (prefix - kUnity);
    if (whole < 3)
        number.insert(static_cast<std::size_t>(whole), 1, '.');
    if (!style.zeros)
        drop_zeros(number);
    const std::string_view name = kPrefixes[static_cast<std::size_t>(prefix)];
    return fmt::format("{}{} {}{}", sign, number, name == "u" ? style.micro : name, base);
}

std::string time_text(double nanoseconds, const NumberStyle& style) {
    NumberStyle used = style;
    used.zeros = style.zeros && nanoseconds >= 999.5; // they are whole
    return quantity(nanoseconds * 1e-9, "s", used);
}

std::string share_text(std::uint64_t part, std::uint64_t whole) {
    if (whole == 0)
        return "";
    if (part == 0 || part >= whole)
        return part == 0 ? " (0 %)" : " (100 %)";
    const double percent = 100 * static_cast<double>(part) / static_cast<double>(whole);
    if (percent >= 99.95)
        return " (> 99.9 %)";
    if (percent < 0.001)
        return fmt::format(" ({:.0f} in 10^9)", std::max(1.0, percent * 1e7));
    const int decimals = percent >= 10 ? 1 : percent >= 1 ? 2 : percent >= 0.1 ? 3 : percent >= 0.01 ? 4 : 5;
    std::string number = fmt::format("{:.{}f}", percent, decimals);
    drop_zeros(number);
    return fmt::format(" ({} %)", number);
}

std::string counted(std::uint64_t count, std::string_view noun) {
    return fmt::format("{} {}{}", count, noun, count == 1 ? "" : "s");
}

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

std::vector<std::string> count_rows(std::span<const NamedTimes> columns) {
    std::vector<Counts> counts;
    std::size_t first = kRows, last = 0;
    const auto any = [&](std::size_t row) {
        return std::any_of(counts.begin(), counts.end(), [&](const Counts& one) { return one[row] > 0; });
    };
    for (const NamedTimes& column : columns)
        counts.push_back(counts_of(column.times));
    const std::size_t shortest = gather_shortest(counts);
    for (std::size_t row = 0; row < kRows; ++row)
        if (any(row)) {
            first = std::min(first, row);
            last = row;
        }
    if (first == kRows)
        return {};
    const std::size_t width = (kColumns - kLabel) / columns.size() - kCount - 1;
    std::string heading = fmt::format("{:<{}}", "how often", kLabel);
    for (const NamedTimes& column : columns)
        heading += fmt::format("{:<{}} ", column.name, width + kCount);
    std::vector<std::string> lines{heading};
    for (std::size_t row = first; row <= last; ++row) {
        if (!any(row)) {
            if (any(row + 1))
                lines.push_back(fmt::format("{:>{}}", "...", kLabel - 2));
            continue;
        }
        std::string line = fmt::format(
            "{:>{}}  ", shortest > 0 && row == shortest ? "below " + time_text(begin_of(row + 1)) : label_of(row),
            kLabel - 2);
        for (const Counts& one : counts) {
            const std::string count = one[row] > 0 ? fmt::format("{}", one[row]) : "";
            const std::string bar = bar_of(one[row], *std::max_element(one.begin(), one.end()), width);
            line += fmt::format("{:<{}} ", bar + (bar.empty() ? "" : " ") + count, width + kCount);
        }
        lines.push_back(line);
    }
    return lines;
}

} // namespace forceshade::device
