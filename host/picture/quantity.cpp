#include "host/picture/quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace forceshade::picture {
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

double round_below(double value) {
    const int exponent = decade(value);
    const double leading = divide_by_power_of_ten(value, exponent);
    const double mantissa = leading >= 5 ? 5 : leading >= 2 ? 2 : 1;
    return divide_by_power_of_ten(mantissa, -exponent);
}

} // namespace forceshade::picture
