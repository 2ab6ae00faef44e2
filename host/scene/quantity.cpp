#include "host/scene/value.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <numbers>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <fmt/format.h>

#include "host/error.h"
#include "host/spelling.h"
#include "host/text.h"

namespace forceshade {

namespace {

template <typename... Parts> [[noreturn]] void refuse(fmt::format_string<Parts...> message, Parts&&... parts) {
    throw UsageError(fmt::format(message, std::forward<Parts>(parts)...));
}

/// A product of powers of m, kg, s and rad. One such unit is numerator / denominator * 10^exponent * (pi / 180)^degrees
/// SI units. The factor is stored as integers because a factor such as 1 mil = 254e-7 m is no binary number.
struct Unit {
    std::array<int, 4> powers{}; // of m, kg, s, rad
    std::uint64_t numerator = 1;
    std::uint64_t denominator = 1;
    int exponent = 0;
    int degrees = 0;
};

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
    constexpr std::string_view kPrefixes = "pnumckMG";
    constexpr std::array<int, 8> kExponents{-12, -9, -6, -3, -2, 3, 6, 9};
    return kExponents[kPrefixes.find(prefix)];
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

std::array<int, 4> quotient_of(const Unit& first, const Unit& second) {
    std::array<int, 4> powers = first.powers;
    for (std::size_t i = 0; i < powers.size(); ++i)
        powers[i] -= second.powers[i];
    return powers;
}

/// Words that stand for a unit of this schema, and what is no more than a conversion away.
struct LookAlike {
    std::string_view names; // between blanks, lower case
    std::string_view write;
};
constexpr LookAlike kLookAlikes[] = {{" inch inches zoll \" ", "in"},
                                     {" thou thous ", "mil"},
                                     {" meter meters metre metres ", "m"},
                                     {" millimeter millimeters millimetre millimetres ", "mm"},
                                     {" centimeter centimeters centimetre centimetres ", "cm"},
                                     {" micron microns micrometer micrometers micrometre micrometres ", "um"},
                                     {" newton newtons ", "N"},
                                     {" sec secs second seconds ", "s"},
                                     {" msec msecs millisecond milliseconds ", "ms"},
                                     {" hertz ", "Hz"},
                                     {" gram grams gramme grammes ", "g"},
                                     {" kilogram kilograms kilo kilos ", "kg"},
                                     {" degree degrees \u00b0 ", "deg"},
                                     {" radian radians ", "rad"},
                                     {" joule joules ", "J"}};
constexpr LookAlike kConversions[] = {{" min mins minute minutes ", "60 s"},
                                      {" h hour hours ", "3600 s"},
                                      {" ft foot feet ", "12 in"},
                                      {" yd yard yards ", "36 in"},
                                      {" lb lbs pound pounds ", "453.59237 g"},
                                      {" lbf ", "4.4482216 N"},
                                      {" oz ounce ounces ", "28.349523 g"},
                                      {" kgf kp ", "9.80665 N"},
                                      {" gf p ", "9.80665 mN"},
                                      {" dyn dyne ", "10 uN"},
                                      {" rpm ", "0.016666667 Hz"},
                                      {" grad gon ", "0.9 deg"}};

const LookAlike* find_word(std::span<const LookAlike> words, std::string_view name) {
    const std::string word = fmt::format(" {} ", lower_case(name));
    const auto found =
        std::ranges::find_if(words, [&](const LookAlike& one) { return one.names.find(word) != one.names.npos; });
    return found == words.end() ? nullptr : &*found;
}

[[noreturn]] void unknown_unit(std::string_view name, const DimensionInfo& wanted) {
    if (name == "min" && wanted.name == "length")
        refuse("unknown unit \"min\": did you mean \"mil\", a thousandth of an inch?");
    if (const LookAlike* word = find_word(kLookAlikes, name))
        refuse("unknown unit \"{}\": did you mean \"{}\"?", name, word->write);
    if (const LookAlike* word = find_word(kConversions, name))
        refuse("unknown unit \"{}\": 1 {} is \"{}\"", name, name, word->write);
    for (std::size_t split = 1; split < name.size(); ++split) {
        const std::string_view first = name.substr(0, split);
        const std::string_view second = name.substr(split);
        const bool plural = second == "s" && split > 1; // "mils" is no product with seconds
        const bool alike = find_symbol(first) && find_symbol(second) &&
                           find_symbol(first)->powers == find_symbol(second)->powers; // "mmm" is no area of m and mm
        if (!plural && !alike && find_symbol(first) && find_symbol(second))
            refuse("unknown unit \"{}\": write \"{} {}\" for a product{}", name, first, second,
                   quotient_of(*find_symbol(first), *find_symbol(second)) == wanted.powers
                       ? fmt::format(", \"{}/{}\" for {}", first, second, wanted.with_article)
                       : "");
    }
    for (const bool any : {false, true}) { // those of the quantity itself first
        std::vector<std::string> names;
        for (const Symbol& symbol : kSymbols) {
            if (!any && symbol.unit.powers != wanted.powers)
                continue;
            names.emplace_back(symbol.name);
            for (const char prefix : symbol.prefixes)
                names.push_back(fmt::format("{}{}", prefix, symbol.name));
        }
        if (const std::string_view near = nearest(name, names); !near.empty())
            refuse("unknown unit \"{}\": did you mean \"{}\"?", name, near);
    }
    refuse(
        "unknown unit \"{}\": known are m, mil, in, kg, g, s, Hz, N, J, rad, deg and SI prefixes, as in \"0.5 N/mm\"",
        name);
}

bool is_symbol_char(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || static_cast<unsigned char>(c) >= 0x80;
}

void multiply(std::uint64_t& product, std::uint64_t factor, std::string_view text) {
    if (__builtin_mul_overflow(product, factor, &product))
        refuse("the powers in the unit \"{}\" are too high", text);
}

void replace_all(std::string& text, std::string_view from, std::string_view to) {
    for (std::size_t at = 0; (at = text.find(from, at)) != text.npos; at += to.size())
        text.replace(at, from.size(), to);
}

// The unit text with every way to write micro and the centred dot made plain ASCII.
std::string plain_ascii(std::string_view text) {
    static constexpr std::array<std::array<std::string_view, 2>, 4> kSpellings{
        {{"\u00b5", "u"}, {"\u03bc", "u"}, {"\u00b7", "*"}, {"\u22c5", "*"}}};
    std::string result(text);
    for (const auto& [from, to] : kSpellings)
        replace_all(result, from, to);
    return result;
}

Unit parse_unit(std::string_view as_written, const DimensionInfo& wanted) {
    const std::string text = plain_ascii(as_written);
    std::string_view rest = text;
    const auto skip = [&](std::size_t characters) {
        const std::string_view skipped = rest.substr(0, characters);
        rest.remove_prefix(skipped.size());
        return skipped;
    };
    const auto skip_spaces = [&] { skip(rest.find_first_not_of(" \t")); };
    const auto skip_char = [&](char c) { return rest.starts_with(c) && !skip(1).empty(); };
    Unit unit;
    bool divided = false;
    for (bool first = true;; first = false) {
        skip_spaces();
        const bool slash = skip_char('/');
        const bool star = !slash && !first && skip_char('*');
        skip_spaces();
        if (rest.empty() && !slash && !star)
            return unit;
        if (divided && !slash)
            refuse("\"{}\" can be read in two ways: write products before the \"/\", and \"/\" before each divisor",
                   text);
        divided = divided || slash;
        const auto length = std::ranges::find_if_not(rest, is_symbol_char) - rest.begin();
        if (length == 0 && rest == "\"")
            unknown_unit(rest, wanted);
        if (length == 0)
            refuse("\"{}\" is not a unit; write for example \"N/mm\" or \"N s/m\"", text);
        const std::string_view name = skip(static_cast<std::size_t>(length));
        const std::optional<Unit> factor = find_symbol(name);
        if (!factor)
            unknown_unit(name, wanted);
        int power = 1;
        if (skip_char('^')) {
            const auto [end, error] = std::from_chars(rest.data(), rest.data() + rest.size(), power);
            if (error != std::errc() || power < -9 || power > 9)
                refuse("a power in the unit \"{}\" is not an integer from -9 to 9", text);
            skip(static_cast<std::size_t>(end - rest.data()));
        }
        power = slash ? -power : power;
        for (std::size_t i = 0; i < unit.powers.size(); ++i)
            unit.powers[i] += factor->powers[i] * power;
        unit.exponent += factor->exponent * power;
        unit.degrees += factor->degrees * power;
        for (int i = 0; i < std::abs(power); ++i)
            multiply(power > 0 ? unit.numerator : unit.denominator, factor->numerator, text);
    }
}

constexpr std::array<DimensionInfo, 10> kDimensions{{
    {"length", "a length", "0.2 mm", "m", {1, 0, 0, 0}},
    {"force", "a force", "1 N", "N", {1, 1, -2, 0}},
    {"stiffness", "a stiffness", "0.5 N/mm", "N/m", {0, 1, -2, 0}},
    {"time", "a time", "60 s", "s", {0, 0, 1, 0}},
    {"frequency", "a frequency", "1 kHz", "Hz", {0, 0, -1, 0}},
    {"mass", "a mass", "0.1 kg", "kg", {0, 1, 0, 0}},
    {"damping", "a damping", "1 N s/m", "N s/m", {0, 1, -1, 0}},
    {"speed", "a speed", "100 mm/s", "m/s", {1, 0, -1, 0}},
    {"angle", "an angle", "90 deg", "rad", {0, 0, 0, 1}},
    {"force rate", "a force rate", "2 N/ms", "N/s", {1, 1, -3, 0}},
}};

constexpr std::size_t kLongestQuantity = 256;
constexpr int kLargestExponent = 100000; // far beyond any double, and far from overflow of the sum below

bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

// A decimal number as written: digits * 10^exponent.
struct Decimal {
    bool negative = false;
    std::string digits;
    int exponent = 0;
    std::size_t length = 0; // characters of the text that it covers
};

// Reads [+-]digits[.digits][e[+-]digits]; `length` is 0 if the text does not begin with a number.
Decimal read_decimal(std::string_view text) {
    const std::size_t sign = text.starts_with('+') || text.starts_with('-');
    double unused = 0;
    const char* const begin = text.data() + sign;
    const auto [end, error] = std::from_chars(begin, text.data() + text.size(), unused);
    const std::string_view written(begin, static_cast<std::size_t>(end - begin));
    if (error == std::errc::invalid_argument || !(is_digit(written[0]) || written[0] == '.')) // no infinity
        return {};
    Decimal number{text[0] == '-', "", 0, sign + written.size()};
    const std::size_t e = written.find_first_of("eE"), point = std::min(written.find('.'), written.size());
    const std::string_view digits = written.substr(0, e);
    std::ranges::copy_if(digits, std::back_inserter(number.digits), is_digit);
    if (e != written.npos) {
        const std::string_view exponent = written.substr(e + (written[e + 1] == '+' ? 2 : 1));
        if (std::from_chars(exponent.data(), exponent.data() + exponent.size(), number.exponent).ec != std::errc())
            number.exponent = kLargestExponent * (exponent[0] == '-' ? -1 : 1);
        number.exponent = std::clamp(number.exponent, -kLargestExponent, kLargestExponent);
    }
    if (point < digits.size())
        number.exponent -= static_cast<int>(digits.size() - point - 1);
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
    std::ranges::reverse(product);
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

[[noreturn]] void refuse_number(std::string_view text, const DimensionInfo& info) {
    if (!text.empty() && is_digit(text[0]) && text.find(',') != std::string_view::npos)
        refuse("\"{}\": write a decimal point, as in \"{}\"", text, info.example);
    refuse("{} is a number and a unit, for example \"{}\"; got \"{}\"", info.with_article, info.example, text);
}

struct Blank {
    std::string_view character, name;
};
constexpr Blank kBlanks[] = {{"\u00a0", "no-break space (U+00A0)"},
                             {"\u202f", "narrow no-break space (U+202F)"},
                             {"\u2007", "figure space, which is a no-break space (U+2007)"},
                             {"\u2009", "thin space (U+2009)"},
                             {"\u2002", "en space (U+2002)"},
                             {"\u2003", "em space (U+2003)"},
                             {"\u200b", "zero-width space (U+200B)"},
                             {"\u2060", "zero-width no-break space (U+2060)"},
                             {"\ufeff", "zero-width no-break space (U+FEFF)"}};

// Blanks that look like a space, or like nothing, come with what is copied from a page or typed with Alt or Option.
void refuse_other_blanks(std::string_view text) {
    for (const auto& [character, name] : kBlanks)
        if (text.find(character) != text.npos) {
            std::string plain(text);
            for (const Blank& blank : kBlanks)
                replace_all(plain, blank.character, " ");
            refuse("\"{}\" contains a {}; write an ordinary space: \"{}\"", text, name, trimmed(plain));
        }
}

// "a force, ", or an empty text for what has no name here.
std::string what_has(const std::array<int, 4>& powers) {
    const auto found = std::ranges::find(kDimensions, powers, &DimensionInfo::powers);
    return found == kDimensions.end() ? "" : fmt::format("{}, ", found->with_article);
}

} // namespace

const DimensionInfo& dimension_info(Dimension dimension) {
    return kDimensions[static_cast<std::size_t>(dimension)];
}

double parse_quantity(std::string_view text, Dimension expected) {
    const DimensionInfo& info = dimension_info(expected);
    text = trimmed(text);
    if (text.size() > kLongestQuantity)
        refuse("{} of {} characters is too long; write for example \"{}\"", info.with_article, text.size(),
               info.example);
    refuse_other_blanks(text);
    const Decimal number = read_decimal(text);
    if (number.length == 0)
        refuse_number(text, info);
    const std::string_view unit_text = trimmed(text.substr(number.length));
    if (unit_text.empty())
        refuse("{} needs a unit, for example \"{}\"; got \"{}\"", info.with_article, info.example, text);
    if (unit_text[0] == ',' || unit_text[0] == '.' || is_digit(unit_text[0]))
        refuse_number(text, info);
    const Unit unit = parse_unit(unit_text, info);
    if (unit.powers != info.powers)
        refuse("\"{}\" is {}not {}; write for example \"{}\"", unit_text, what_has(unit.powers), info.with_article,
               info.example);
    const double value = convert(number, unit);
    const bool zero = number.digits.find_first_not_of('0') == std::string::npos;
    if (!std::isfinite(value) || (value == 0 && !zero))
        refuse("\"{}\" is too {} for a double", text,
               number.exponent + static_cast<int>(number.digits.size()) > 0 ? "large" : "small");
    return value;
}

std::string in_unit_of(std::string_view quantity, double number, Dimension dimension) {
    quantity = trimmed(quantity);
    const std::string_view unit = trimmed(quantity.substr(read_decimal(quantity).length));
    return fmt::format("{:.6g} {}", number / parse_quantity(fmt::format("1 {}", unit), dimension), unit);
}

} // namespace forceshade
