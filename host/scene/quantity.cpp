#include "host/scene/quantity.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/scene/value.h"

namespace forceshade {

namespace {

struct Symbol {
    std::string_view name;
    std::string_view prefixes; // SI prefixes that make sense with it
    Unit unit;
};

// 1 in = 25.4 mm exactly; 1 mil = in/1000.
constexpr std::array<Symbol, 10> kSymbols{{
    {"m", "pnumck", {{1, 0, 0, 0}, 1, 1, 0, 0}},
    {"mil", "", {{1, 0, 0, 0}, 254, 1, -7, 0}},
    {"in", "", {{1, 0, 0, 0}, 254, 1, -4, 0}},
    {"g", "umk", {{0, 1, 0, 0}, 1, 1, -3, 0}},
    {"s", "num", {{0, 0, 1, 0}, 1, 1, 0, 0}},
    {"Hz", "mkMG", {{0, 0, -1, 0}, 1, 1, 0, 0}},
    {"N", "numkM", {{1, 1, -2, 0}, 1, 1, 0, 0}},
    {"J", "numk", {{2, 1, -2, 0}, 1, 1, 0, 0}},
    {"rad", "um", {{0, 0, 0, 1}, 1, 1, 0, 0}},
    {"deg", "", {{0, 0, 0, 1}, 1, 1, 0, 1}},
}};

// Of an SI prefix.
int prefix_exponent(char prefix) {
    constexpr std::pair<char, int> kPrefixes[] = {{'p', -12}, {'n', -9}, {'u', -6}, {'m', -3},
                                                  {'c', -2},  {'k', 3},  {'M', 6},  {'G', 9}};
    return std::find_if(std::begin(kPrefixes), std::end(kPrefixes),
                        [&](const auto& one) { return one.first == prefix; })
        ->second;
}

std::optional<Unit> find_symbol(std::string_view name) {
    for (const Symbol& symbol : kSymbols) {
        if (name == symbol.name)
            return symbol.unit;
        if (name.size() == symbol.name.size() + 1 && name.substr(1) == symbol.name &&
            symbol.prefixes.find(name[0]) != std::string_view::npos) {
            Unit unit = symbol.unit;
            unit.exponent += prefix_exponent(name[0]);
            return unit;
        }
    }
    return std::nullopt;
}

std::vector<std::string> all_names() {
    std::vector<std::string> names;
    for (const Symbol& symbol : kSymbols) {
        names.emplace_back(symbol.name);
        for (const char prefix : symbol.prefixes)
            names.push_back(fmt::format("{}{}", prefix, symbol.name));
    }
    return names;
}

[[noreturn]] void unknown_unit(std::string_view name) {
    for (std::size_t split = 1; split < name.size(); ++split) {
        const std::string_view first = name.substr(0, split);
        const std::string_view second = name.substr(split);
        const bool plural = second == "s" && split > 1; // "mils" is no product with seconds
        if (!plural && find_symbol(first) && find_symbol(second))
            throw UsageError(fmt::format("unknown unit \"{}\": write \"{} {}\" for a product", name, first, second));
    }
    const std::vector<std::string> names = all_names();
    const std::string_view near = nearest(name, names);
    if (!near.empty())
        throw UsageError(fmt::format("unknown unit \"{}\": did you mean \"{}\"?", name, near));
    throw UsageError(
        fmt::format("unknown unit \"{}\": known are m, mil, in, kg, g, s, Hz, N, J, rad, deg and SI prefixes, "
                    "as in \"0.5 N/mm\"",
                    name));
}

bool is_symbol_char(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

void multiply(std::uint64_t& product, std::uint64_t factor, std::string_view text) {
    if (__builtin_mul_overflow(product, factor, &product))
        throw UsageError(fmt::format("the powers in the unit \"{}\" are too high", text));
}

// The unit text with every way to write micro and the centred dot made plain ASCII.
std::string plain_ascii(std::string_view text) {
    static constexpr std::array<std::array<std::string_view, 2>, 4> kSpellings{
        {{"\u00b5", "u"}, {"\u03bc", "u"}, {"\u00b7", "*"}, {"\u22c5", "*"}}};
    std::string result(text);
    for (const auto& [from, to] : kSpellings)
        for (std::size_t at = result.find(from); at != std::string::npos; at = result.find(from, at))
            result.replace(at, from.size(), to);
    return result;
}

class UnitParser {
public:
    explicit UnitParser(std::string_view text) : text_(text), rest_(text) {}

    Unit parse() {
        bool divide = false;
        bool divided = false;
        for (bool first = true;; first = false) {
            skip_spaces();
            const bool slash = take('/');
            const bool star = !slash && !first && take('*');
            skip_spaces();
            if (rest_.empty() && !slash && !star)
                return unit_;
            if (divided && !slash)
                throw UsageError(fmt::format("\"{}\" can be read in two ways: write products before the \"/\", "
                                             "and \"/\" before each divisor",
                                             text_));
            divide = slash;
            divided = divided || slash;
            take_factor(divide);
        }
    }

private:
    void skip_spaces() {
        while (!rest_.empty() && (rest_[0] == ' ' || rest_[0] == '\t'))
            rest_.remove_prefix(1);
    }

    bool take(char c) {
        if (rest_.empty() || rest_[0] != c)
            return false;
        rest_.remove_prefix(1);
        return true;
    }

    void take_factor(bool divide) {
        std::size_t length = 0;
        while (length < rest_.size() && is_symbol_char(rest_[length]))
            ++length;
        if (length == 0)
            throw UsageError(fmt::format("\"{}\" is not a unit; write for example \"N/mm\" or \"N s/m\"", text_));
        const std::string_view name = rest_.substr(0, length);
        rest_.remove_prefix(length);
        const std::optional<Unit> factor = find_symbol(name);
        if (!factor)
            unknown_unit(name);
        const int power = take_power();
        apply(*factor, divide ? -power : power);
    }

    int take_power() {
        if (!take('^'))
            return 1;
        int power = 0;
        const auto [end, error] = std::from_chars(rest_.data(), rest_.data() + rest_.size(), power);
        if (error != std::errc() || power < -9 || power > 9)
            throw UsageError(fmt::format("a power in the unit \"{}\" is not an integer from -9 to 9", text_));
        rest_.remove_prefix(static_cast<std::size_t>(end - rest_.data()));
        return power;
    }

    void apply(const Unit& factor, int power) {
        for (std::size_t i = 0; i < unit_.powers.size(); ++i)
            unit_.powers[i] += factor.powers[i] * power;
        unit_.exponent += factor.exponent * power;
        unit_.degrees += factor.degrees * power;
        for (int i = 0; i < power; ++i)
            multiply(unit_.numerator, factor.numerator, text_);
        for (int i = 0; i > power; --i)
            multiply(unit_.denominator, factor.numerator, text_);
    }

    std::string_view text_;
    std::string_view rest_;
    Unit unit_;
};

} // namespace

Unit parse_unit(std::string_view text) {
    const std::string plain = plain_ascii(text);
    return UnitParser(plain).parse();
}

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
