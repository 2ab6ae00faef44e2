#include "host/numbers.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>

#include <fmt/format.h>

namespace forceshade::numbers {
namespace {

constexpr int kFirstPrefix = -24;
constexpr std::array<std::string_view, 17> kPrefixes{"y", "z", "a", "f", "p", "n", "µ", "m", "",
                                                     "k", "M", "G", "T", "P", "E", "Z", "Y"};

std::string unit_name(int exponent, std::string_view base) {
    const int prefix = (exponent - kFirstPrefix) / 3;
    if (exponent < kFirstPrefix || prefix >= static_cast<int>(kPrefixes.size()))
        return fmt::format("10{} {}", superscript(exponent), base);
    return fmt::format("{}{}", kPrefixes[static_cast<std::size_t>(prefix)], base);
}

bool has_prefix(const Unit& unit) {
    return unit.name.find(' ') == std::string::npos;
}

} // namespace

std::string superscript(int number) {
    constexpr std::array<std::string_view, 10> kDigits{"⁰", "¹", "²", "³", "⁴", "⁵", "⁶", "⁷", "⁸", "⁹"};
    std::string text = number < 0 ? "⁻" : "";
    for (const char digit : fmt::format("{}", std::abs(number)))
        text += kDigits[static_cast<std::size_t>(digit - '0')];
    return text;
}

int decade(double value) {
    const std::string text = fmt::format("{:.16e}", value);
    int exponent = 0;
    const char* begin = text.data() + text.find('e') + 1;
    if (*begin == '+') // from_chars takes no plus sign
        ++begin;
    std::from_chars(begin, text.data() + text.size(), exponent);
    return exponent;
}

double divide_by_power_of_ten(double value, int exponent) {
    return static_cast<double>(value / std::pow(10.0L, exponent));
}

Unit choose_unit(double largest, std::string_view base) {
    const int leading = decade(largest);
    int exponent = 3 * static_cast<int>(std::floor(leading / 3.0));
    if (base == "m" && exponent > 3 && exponent <= 6)
        exponent = 3;
    return {exponent, unit_name(exponent, base)};
}

std::string with_unit(const std::string& number, const Unit& unit) {
    return fmt::format("{}{}{}", number, has_prefix(unit) ? " " : " × ", unit.name);
}

std::string per_unit(const Unit& unit) {
    return has_prefix(unit) ? " / " + unit.name : " / (" + unit.name + ")";
}

std::string decimal(double value, int decimals) {
    std::string text = fmt::format("{:.{}f}", std::fabs(value), std::max(decimals, 0));
    const bool zero = text.find_first_not_of("0.") == std::string::npos;
    return value < 0 && !zero ? "−" + text : text;
}

std::string trimmed(double value, int decimals) {
    return decimal(value, needed_decimals(value, decimals));
}

std::string three_digits(double value) {
    const int exponent = decade(value);
    if (exponent >= -2 && exponent < 5)
        return trimmed(value, std::max(0, 2 - exponent));
    return trimmed(divide_by_power_of_ten(value, exponent), 2) + " × 10" + superscript(exponent);
}

std::string quantity_text(double value, std::string_view base) {
    if (!(value > 0))
        return fmt::format("0 {}", base);
    const Unit unit = choose_unit(value, base);
    return with_unit(three_digits(divide_by_power_of_ten(value, unit.exponent)), unit);
}

int needed_decimals(double value, int most) {
    const std::string text = decimal(value, most);
    const std::size_t point = text.find('.');
    if (point == std::string::npos)
        return 0;
    const std::size_t last = text.find_last_not_of('0'); // the point itself if all decimals are 0
    return static_cast<int>(last - point);
}

std::string number_label(double value, int decimals) {
    const double size = std::fabs(value);
    if (value == 0 || (size >= 0.9999e-3 && size < 1e5))
        return decimal(value, decimals);
    const int exponent = decade(size * (1 + 1e-12));
    const std::string mantissa = trimmed(divide_by_power_of_ten(size, exponent), 5);
    return (value < 0 ? "−" : "") + (mantissa == "1" ? "10" : mantissa + "×10") + superscript(exponent);
}

std::string number_text(double value, int digits) {
    if (value == 0)
        return "0";
    if (!std::isfinite(value))
        return "no number";
    const double rounded = std::stod(fmt::format("{:.{}e}", value, digits - 1));
    const int decimals = std::max(0, digits - 1 - decade(std::fabs(rounded)));
    return number_label(rounded, needed_decimals(rounded, decimals));
}

std::string counted(std::uint64_t count, std::string_view one, std::string_view many) {
    return fmt::format("{} {}{}", count, count == 1 || many.empty() ? one : many,
                       count != 1 && many.empty() ? "s" : "");
}

std::string count_text(std::uint64_t count) {
    std::string text = fmt::format("{}", count);
    for (std::size_t i = text.size(); i > 3;) {
        i -= 3;
        text.insert(i, "\u00a0");
    }
    return text;
}

std::string duration_text(double seconds) {
    if (!(seconds >= 0) || seconds > 1e9)
        return "an unknown time";
    if (seconds < 60)
        return trimmed(seconds, seconds < 10 ? 1 : 0) + " s";
    const auto whole = static_cast<std::uint64_t>(std::lround(seconds));
    if (whole < 3600)
        return fmt::format("{} min {} s", whole / 60, whole % 60);
    return fmt::format("{} h {} min", whole / 3600, whole / 60 % 60);
}

std::string size_text(double bytes) {
    constexpr std::array kUnits{"bytes", "kB", "MB", "GB", "TB", "PB", "EB"};
    std::size_t unit = 0;
    for (; bytes >= 999.5 && unit + 1 < kUnits.size(); ++unit)
        bytes /= 1000;
    return unit == 0 ? fmt::format("{:.0f} bytes", bytes) : fmt::format("{:.3g} {}", bytes, kUnits[unit]);
}

} // namespace forceshade::numbers
