#include "device/report/units.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

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

} // namespace

std::string quantity(double value, std::string_view base, const NumberStyle& style) {
    if (!std::isfinite(value))
        return "unknown";
    if (value == 0)
        return fmt::format("0 {}", base);
    const char* sign = value < 0 ? "-" : "";
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

} // namespace forceshade::device
