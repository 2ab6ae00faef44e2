// A scene or study: read or refused with its places told; what is read stays the same through its resolved text.
#include "host/error.h"
#include "host/scene/schema.h"
#include "host/scene/study.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade {
namespace {

using fuzz::require;

constexpr std::size_t kMostCases = 40;

void check_same(const Study& one, const Study& other) {
    require(one.cases.size() == other.cases.size(), "{} cases become {}", one.cases.size(), other.cases.size());
    for (std::size_t i = 0; i < one.cases.size(); ++i) {
        require(one.cases[i].name == other.cases[i].name, "case {} becomes {}", one.cases[i].name, other.cases[i].name);
        require(one.cases[i].scene == other.cases[i].scene, "{}: the scene becomes another", one.cases[i].name);
        require(one.cases[i].varied == other.cases[i].varied, "{}: what varies is told otherwise", one.cases[i].name);
        require(resolved_toml(one.cases[i]) == resolved_toml(other.cases[i]), "{}: resolved otherwise",
                one.cases[i].name);
    }
}

void check_study(std::string_view text) {
    Study study;
    try {
        study = parse_study(text, "f.toml", "/folder");
    } catch (const UsageError& error) {
        require(std::string_view(error.what()).starts_with("f.toml:"), "a message without its place: {}", error.what());
        return;
    }
    const std::string resolved = resolved_toml(study);
    if (study.cases.size() > kMostCases)
        return;
    const Study again = parse_study(resolved, "resolved.toml", "/folder");
    check_same(study, again);
    require(resolved_toml(again) == resolved, "resolved again, the text is another");
    for (const Case& one : study.cases) {
        const Case back = parse_scene(resolved_toml(one), "case.toml", "/folder");
        require(back.scene == one.scene, "{}: a case's text gives another scene", one.name);
    }
}

/// "KEY=VALUE", as given on a command line, and below it the text that it overrides.
void check_override(std::string_view input) {
    const std::size_t end = std::min(input.find('\n'), input.size());
    const std::string_view text = input.substr(0, end), below = input.substr(std::min(end + 1, input.size()));
    const std::size_t equals = std::min(text.find('='), text.size());
    const Override one{text.substr(0, equals), text.substr(std::min(equals + 1, text.size()))};
    try {
        const Study study = parse_study(below, "f.toml", "/folder", std::span(&one, 1));
        if (study.cases.size() <= kMostCases)
            check_same(study, parse_study(resolved_toml(study), "resolved.toml", "/folder"));
    } catch (const UsageError&) {
    }
}

/// Of simple units, the value is the nearest double or next to it: their factors are exact in decimals.
void check_value(std::string_view text, Dimension dimension, double value) {
    struct Simple {
        const char* unit;
        Dimension dimension;
        long double numerator, denominator;
    };
    const std::size_t blank = text.rfind(' ');
    if (blank == text.npos || text.find_first_not_of("+-.0123456789eE") != blank)
        return;
    for (const Simple& one : {Simple{"mil", Dimension::length, 254, 1e7L},
                              {"in", Dimension::length, 254, 1e4L},
                              {"mm", Dimension::length, 1, 1e3L},
                              {"N/mm", Dimension::stiffness, 1e3L, 1}})
        if (text.substr(blank + 1) == one.unit && dimension == one.dimension) {
            const long double expected =
                std::strtold(std::string(text.substr(0, blank)).c_str(), nullptr) * one.numerator / one.denominator;
            const double ulp = std::nextafter(std::abs(value), INFINITY) - std::abs(value);
            require(std::abs(expected - static_cast<long double>(value)) <= 0.51L * static_cast<long double>(ulp),
                    "\"{}\" is {}", text, value);
        }
}

/// A quantity that is read is written in SI units and read as the same.
void check_quantity(std::string_view text) {
    for (const Dimension dimension : {Dimension::length, Dimension::stiffness, Dimension::damping, Dimension::angle}) {
        try {
            const double value = parse_quantity(text, dimension);
            check_value(text, dimension, value);
            const std::string back = fmt::format("{} {}", value, dimension_info(dimension).unit);
            require(parse_quantity(back, dimension) == value, "\"{}\" is {}, but \"{}\" is not", text, value, back);
        } catch (const UsageError&) {
        }
    }
}

} // namespace
} // namespace forceshade

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string_view text(reinterpret_cast<const char*>(data), size);
    if (text.starts_with("quantity "))
        forceshade::check_quantity(text.substr(9));
    else if (text.starts_with("override "))
        forceshade::check_override(text.substr(9));
    else
        forceshade::check_study(text);
    return 0;
}
