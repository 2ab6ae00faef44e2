#include "host/scene/unit.h"

#include "host/error.h"
#include "host/scene/nearest.h"

#include <charconv>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>

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

int prefix_exponent(char prefix) {
    switch (prefix) {
    case 'p':
        return -12;
    case 'n':
        return -9;
    case 'u':
        return -6;
    case 'm':
        return -3;
    case 'c':
        return -2;
    case 'k':
        return 3;
    case 'M':
        return 6;
    default:
        return 9; // G
    }
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

} // namespace forceshade
