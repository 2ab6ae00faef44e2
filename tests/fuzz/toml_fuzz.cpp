// A scene or study: read or refused with its places told; what is read stays the same through its resolved text.
#include <map>
#include <numbers>
#include <optional>
#include <regex>

#include "host/error.h"
#include "host/scene/document.h"
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

/// Quantities that must be positive are, and of the files of one list all have a digest or none.
void check_cases(const Study& study) {
    for (const Case& one : study.cases)
        for (const Setting& setting : one.settings) {
            const Key& key = schema_keys()[key_index(fmt::format("{}.{}", setting.table, setting.name))];
            if (key.kind != ValueKind::quantity || setting.literal.front() != '"' ||
                setting.literal.find('\\') != std::string::npos)
                continue;
            const double value = parse_quantity(setting.literal.substr(1, setting.literal.size() - 2), key.dimension);
            require(key.sign == Sign::any || value > 0 || (key.sign == Sign::not_negative && value == 0),
                    "{}: {} is {}", one.name, key.path(), setting.literal);
        }
    if (!study.document->variants.empty() || study.cases.size() > kMostCases)
        return;
    const SurfaceSpec& first = study.cases.front().scene.surface;
    for (const Case& one : study.cases)
        require(one.scene.surface.kind != first.kind ||
                    (one.scene.surface.mesh.sha256.empty() == first.mesh.sha256.empty() &&
                     one.scene.surface.map.sha256.empty() == first.map.sha256.empty()),
                "{}: some files have a digest", one.name);
}

/// What messages say of sizes is true of the sizes that they quote.
void check_complaints(const std::string& message) {
    static const std::regex kSign("must (be positive|not be negative), got ([-+.0-9eE]+)[^\n]*");
    static const std::regex kHalf("radius must be at least half of width: ([^\n]*) is less than half of ([^\n,]*)");
    for (std::sregex_iterator one(message.begin(), message.end(), kSign), end; one != end; ++one) {
        const double number = std::strtod((*one)[2].str().c_str(), nullptr);
        require((*one)[1] == "be positive" ? !(number > 0) : number < 0, "{}", message);
    }
    for (std::sregex_iterator one(message.begin(), message.end(), kHalf), end; one != end; ++one)
        require(2 * parse_quantity((*one)[1].str(), Dimension::length) <
                    parse_quantity((*one)[2].str(), Dimension::length),
                "{}", message);
}

/// Of files in a list each has the digest that stands in the same place.
void check_digests(std::string_view text, const Study& study) {
    const TomlNode root = parse_toml(text, "f.toml");
    const TomlNode* const surface = root.find("surface");
    const TomlNode* const files = surface ? surface->find("file") : nullptr;
    const TomlNode* const digests = files ? surface->find("sha256") : nullptr;
    if (!digests || files->type != TomlNode::Type::array || !study.document->variants.empty())
        return;
    std::map<std::string, std::string> expected;
    for (std::size_t i = 0; i < files->items.size(); ++i)
        if (!expected.emplace(files->items[i].text, digests->items.at(i).text).second)
            return; // one file twice
    for (const Case& one : study.cases)
        for (const FileSpec* file : {static_cast<const FileSpec*>(&one.scene.surface.mesh),
                                     static_cast<const FileSpec*>(&one.scene.surface.map)})
            require(file->file.empty() || file->sha256 == expected.at(file->file), "{}: {} has the digest {}", one.name,
                    file->file, file->sha256);
}

void check_study(std::string_view text) {
    Study study;
    try {
        study = parse_study(text, "f.toml", "/folder");
    } catch (const UsageError& error) {
        require(std::string_view(error.what()).starts_with("f.toml:"), "a message without its place: {}", error.what());
        check_complaints(error.what());
        return;
    }
    check_cases(study);
    check_digests(text, study);
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
        check_cases(study);
        for (const Case& each : study.cases) // whatever the file and its variants say
            for (const Setting& setting : each.settings)
                if (const Key& key = schema_keys()[key_index(fmt::format("{}.{}", setting.table, setting.name))];
                    key.path() == one.first && !one.second.starts_with('[') &&
                    (key.kind == ValueKind::quantity || key.kind == ValueKind::choice))
                    require(setting.literal == toml_string(one.second), "{}: {} is {}, not {}", each.name, one.first,
                            setting.literal, one.second);
        if (study.cases.size() <= kMostCases)
            check_same(study, parse_study(resolved_toml(study), "resolved.toml", "/folder"));
    } catch (const UsageError& error) {
        check_complaints(error.what());
    }
}

/// A unit of one symbol with or without a prefix, in SI units: exactly the ratio of two numbers, but for degrees.
struct Factor {
    long double numerator = 1, denominator = 1;
};
std::optional<Factor> factor_of(std::string_view unit) {
    static const std::map<std::string_view, Factor> symbols{
        {"m", {}},           {"mil", {254, 1e7L}},
        {"in", {254, 1e4L}}, {"g", {1, 1e3L}},
        {"s", {}},           {"Hz", {}},
        {"N", {}},           {"J", {}},
        {"rad", {}},         {"deg", {std::numbers::pi_v<long double>, 180}}};
    static const std::map<char, Factor> prefixes{{'p', {1, 1e12L}}, {'n', {1, 1e9L}}, {'u', {1, 1e6L}},
                                                 {'m', {1, 1e3L}},  {'c', {1, 1e2L}}, {'k', {1e3L, 1}},
                                                 {'M', {1e6L, 1}},  {'G', {1e9L, 1}}};
    if (const auto symbol = symbols.find(unit); symbol != symbols.end())
        return symbol->second;
    const auto symbol = symbols.find(unit.substr(std::min<std::size_t>(unit.size(), 1)));
    const auto prefix = prefixes.find(unit.empty() ? ' ' : unit.front());
    if (symbol == symbols.end() || prefix == prefixes.end())
        return {};
    return Factor{symbol->second.numerator * prefix->second.numerator,
                  symbol->second.denominator * prefix->second.denominator};
}

/// Products, quotients and powers, factor by factor; nothing of a unit that is written in another way.
std::optional<long double> factor_of_product(std::string_view unit) {
    static const std::regex kFactor("(/?) ?([A-Za-z]+)(?:\\^(-?[1-9]))? ?");
    long double product = 1;
    for (std::cmatch one; !unit.empty(); unit.remove_prefix(static_cast<std::size_t>(one.length()))) {
        if (!std::regex_search(unit.data(), unit.data() + unit.size(), one, kFactor,
                               std::regex_constants::match_continuous))
            return {};
        const std::optional<Factor> factor = factor_of(one[2].str());
        if (!factor)
            return {};
        const int power = (one[3].matched ? std::stoi(one[3].str()) : 1) * (one[1].length() ? -1 : 1);
        product *= std::pow(factor->numerator / factor->denominator, static_cast<long double>(power));
    }
    return product;
}

/// Of any unit the value is near to that.
void check_product(std::string_view text, double value) {
    const std::size_t blank = std::min(text.find(' '), text.size());
    const auto factor = factor_of_product(text.substr(std::min(blank + 1, text.size())));
    if (blank == 0 || text.substr(0, blank).find_first_not_of("+-.0123456789eE") != text.npos || !factor ||
        !(std::abs(value) > 1e-290 && std::abs(value) < 1e290))
        return;
    const long double expected = std::strtold(std::string(text.substr(0, blank)).c_str(), nullptr) * *factor;
    require(std::abs(expected - static_cast<long double>(value)) <= 1e-13L * std::abs(expected), "\"{}\" is {}, not {}",
            text, value, static_cast<double>(expected));
}

/// Of a unit, or of one over another, the value is the nearest double; of degrees and over inches one near to it.
void check_value(std::string_view text, double value) {
    require(value != 0 || !std::signbit(value), "\"{}\" is -0", text);
    const std::size_t blank = text.rfind(' ');
    if (blank == text.npos || text.find_first_not_of("+-.0123456789eE") != blank)
        return;
    const std::string_view unit = text.substr(blank + 1);
    const std::size_t slash = std::min(unit.find('/'), unit.size());
    const std::optional<Factor> over = slash < unit.size() ? factor_of(unit.substr(slash + 1)) : Factor{};
    const std::optional<Factor> factor = factor_of(unit.substr(0, slash));
    if (!factor || !over || !(std::abs(value) > 1e-290 && std::abs(value) < 1e290))
        return;
    const long double expected = std::strtold(std::string(text.substr(0, blank)).c_str(), nullptr) *
                                 (factor->numerator * over->denominator) / (factor->denominator * over->numerator);
    const double ulp = std::nextafter(std::abs(value), INFINITY) - std::abs(value);
    const bool is_exact = unit.find("deg") == unit.npos && unit.find('i', slash) == unit.npos;
    require(std::abs(expected - static_cast<long double>(value)) <=
                (is_exact ? 0.51L : 8.0L) * static_cast<long double>(ulp),
            "\"{}\" is {}", text, value);
}

/// A quantity that is read is written in SI units and read as the same.
void check_quantity(std::string_view text) {
    for (int i = 0; i <= static_cast<int>(Dimension::force_rate); ++i) {
        const auto dimension = static_cast<Dimension>(i);
        try {
            const double value = parse_quantity(text, dimension);
            check_value(text, value);
            check_product(text, value);
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
