#include "host/scene/quantity.h"

#include "host/error.h"
#include "host/scene/unit.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>

#include <fmt/format.h>

namespace forceshade {

namespace {

struct DimensionInfo {
    std::string_view name;
    std::string_view article;
    std::string_view example;
    std::string_view unit;
    std::array<int, 4> powers; // of m, kg, s, rad
};

constexpr std::array<DimensionInfo, 10> kDimensions{{
    {"length", "a", "0.2 mm", "m", {1, 0, 0, 0}},
    {"force", "a", "1 N", "N", {1, 1, -2, 0}},
    {"stiffness", "a", "0.5 N/mm", "N/m", {0, 1, -2, 0}},
    {"time", "a", "60 s", "s", {0, 0, 1, 0}},
    {"frequency", "a", "1 kHz", "Hz", {0, 0, -1, 0}},
    {"mass", "a", "0.1 kg", "kg", {0, 1, 0, 0}},
    {"damping", "a", "1 N s/m", "N s/m", {0, 1, -1, 0}},
    {"speed", "a", "100 mm/s", "m/s", {1, 0, -1, 0}},
    {"angle", "an", "90 deg", "rad", {0, 0, 0, 1}},
    {"force rate", "a", "2 N/ms", "N/s", {1, 1, -3, 0}},
}};

constexpr std::size_t kLongestQuantity = 256;
constexpr int kLargestExponent = 100000; // far beyond any double, and far from overflow of the sum below

const DimensionInfo& info(Dimension dimension) {
    return kDimensions[static_cast<std::size_t>(dimension)];
}

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// A decimal number as written: digits * 10^exponent.
struct Decimal {
    bool negative = false;
    std::string digits;
    int exponent = 0;
    std::size_t length = 0; // characters of the text that it took
};

std::size_t take_digits(std::string_view text, std::size_t at, std::string& digits) {
    while (at < text.size() && is_digit(text[at]))
        digits += text[at++];
    return at;
}

std::size_t take_exponent(std::string_view text, std::size_t at, int& exponent) {
    if (at >= text.size() || (text[at] != 'e' && text[at] != 'E'))
        return at;
    std::size_t first = at + 1;
    const bool minus = first < text.size() && text[first] == '-';
    if (first < text.size() && (text[first] == '-' || text[first] == '+'))
        ++first;
    if (first >= text.size() || !is_digit(text[first]))
        return at; // no exponent but the beginning of a unit
    int value = 0;
    std::size_t end = first;
    for (; end < text.size() && is_digit(text[end]); ++end)
        value = std::min(kLargestExponent, value * 10 + (text[end] - '0'));
    exponent += minus ? -value : value;
    return end;
}

// Reads [+-]digits[.digits][e[+-]digits]; `length` is 0 if the text does not begin with a number.
Decimal read_decimal(std::string_view text) {
    Decimal number;
    std::size_t at = 0;
    if (!text.empty() && (text[0] == '+' || text[0] == '-'))
        number.negative = text[at++] == '-';
    at = take_digits(text, at, number.digits);
    if (at < text.size() && text[at] == '.') {
        const std::size_t whole = number.digits.size();
        at = take_digits(text, at + 1, number.digits);
        number.exponent = -static_cast<int>(number.digits.size() - whole);
    }
    if (number.digits.empty())
        return {};
    number.length = take_exponent(text, at, number.exponent);
    return number;
}

// Multiplies a string of decimal digits by a factor, exactly.
std::string multiply_digits(std::string_view digits, std::uint64_t factor) {
    std::string product;
    unsigned __int128 carry = 0;
    for (std::size_t i = digits.size(); i-- > 0;) {
        carry += static_cast<unsigned __int128>(factor) * static_cast<unsigned>(digits[i] - '0');
        product += static_cast<char>('0' + static_cast<int>(carry % 10));
        carry /= 10;
    }
    for (; carry != 0; carry /= 10)
        product += static_cast<char>('0' + static_cast<int>(carry % 10));
    std::reverse(product.begin(), product.end());
    return product;
}

// The number in SI units. Not a number if a double cannot hold it.
double convert(const Decimal& number, const Unit& unit) {
    const std::string text =
        fmt::format("{}e{}", multiply_digits(number.digits, unit.numerator), number.exponent + unit.exponent);
    double value = 0;
    if (std::from_chars(text.data(), text.data() + text.size(), value).ec != std::errc())
        return std::nan("");
    if (unit.denominator != 1)
        value /= static_cast<double>(unit.denominator);
    for (int i = 0; i < unit.degrees; ++i)
        value = value * std::numbers::pi / 180;
    for (int i = 0; i > unit.degrees; --i)
        value = value * 180 / std::numbers::pi;
    return number.negative && value != 0 ? -value : value; // no negative zero: it would be a second text for one value
}

[[noreturn]] void refuse_number(std::string_view text, Dimension expected) {
    if (!text.empty() && is_digit(text[0]) && text.find(',') != std::string_view::npos)
        throw UsageError(fmt::format("\"{}\": write a decimal point, as in \"{}\"", text, dimension_example(expected)));
    throw UsageError(fmt::format("{} is a number and a unit, for example \"{}\"; got \"{}\"",
                                 dimension_with_article(expected), dimension_example(expected), text));
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && (text.front() == ' ' || text.front() == '\t'))
        text.remove_prefix(1);
    while (!text.empty() && (text.back() == ' ' || text.back() == '\t'))
        text.remove_suffix(1);
    return text;
}

} // namespace

std::string_view dimension_name(Dimension dimension) {
    return info(dimension).name;
}

std::string dimension_with_article(Dimension dimension) {
    return fmt::format("{} {}", info(dimension).article, info(dimension).name);
}

std::string_view dimension_example(Dimension dimension) {
    return info(dimension).example;
}

std::string_view dimension_unit(Dimension dimension) {
    return info(dimension).unit;
}

double parse_quantity(std::string_view text, Dimension expected) {
    text = trimmed(text);
    if (text.size() > kLongestQuantity)
        throw UsageError(fmt::format("{} of {} characters is too long; write for example \"{}\"",
                                     dimension_with_article(expected), text.size(), dimension_example(expected)));
    const Decimal number = read_decimal(text);
    if (number.length == 0)
        refuse_number(text, expected);
    const std::string_view unit_text = trimmed(text.substr(number.length));
    if (unit_text.empty())
        throw UsageError(fmt::format("{} needs a unit, for example \"{}\"; got \"{}\"",
                                     dimension_with_article(expected), dimension_example(expected), text));
    if (unit_text[0] == ',' || unit_text[0] == '.' || is_digit(unit_text[0]))
        refuse_number(text, expected);
    const Unit unit = parse_unit(unit_text);
    if (unit.powers != info(expected).powers)
        throw UsageError(fmt::format("\"{}\" is not {}; write for example \"{}\"", unit_text,
                                     dimension_with_article(expected), dimension_example(expected)));
    const double value = convert(number, unit);
    const bool zero = number.digits.find_first_not_of('0') == std::string::npos;
    if (!std::isfinite(value) || (value == 0 && !zero))
        throw UsageError(fmt::format("\"{}\" is too {} for a double", text,
                                     number.exponent + static_cast<int>(number.digits.size()) > 0 ? "large" : "small"));
    return value;
}

} // namespace forceshade
