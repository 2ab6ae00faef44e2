#include "host/scene/value.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <filesystem>
#include <utility>
#include <vector>

#include <fmt/ranges.h>

#include "host/error.h"
#include "host/scene/document.h"
#include "host/scene/schema.h"
#include "host/spelling.h"
#include "host/text.h"

namespace forceshade {

namespace {

constexpr std::size_t kLongestText = 500; // characters of a title or question

// What is asked for by a name that no choice has.
struct OtherName {
    std::string_view key, names, hint;
};
constexpr OtherName kOtherNames[]{
    {"surface.kind", " sphere ball ellipsoid torus cube box cone ",
     "\"mesh\" takes any shape from a file: forceshade init mesh FILE"},
    {"surface.kind", " plane flat wall ", "a plane is a \"bump\" with facets = 1"},
    {"surface.kind", " cylinder round arc ", "a \"bump\" is a cylinder of `radius` made of facets"},
    {"surface.kind", " image heightmap texture gaussian sine dip ",
     "that is a \"height_map\", chosen by its `function` or `file`"},
    {"output.channels", " normal normals direction ",
     "the direction is that of \"force\"; turned by shading from that of \"unshaded\""},
    {"output.channels", " penetration distance ", "that is \"depth\""},
    {"output.channels", " position contact point god_object ", "that is \"proxy\""},
    {"force.shading", " phong gouraud smooth on ",
     "vertex normals shade by \"morgenbesser\", \"barycentric\" or \"mean_value\" (a mesh), the smooth cylinder by "
     "\"reference\""},
    {"force.shading", " flat off unshaded ", "that is \"none\""},
};

std::string hint_for(std::string_view key, std::string_view name) {
    const std::string word = fmt::format(" {} ", lower_case(name));
    for (const OtherName& other : kOtherNames)
        if (other.key == key && other.names.find(word) != std::string_view::npos)
            return fmt::format("; {}", other.hint);
    return "";
}

using Type = TomlNode::Type;

std::string base_name(std::string_view file) {
    return std::filesystem::path(file).filename().string();
}

class ValueReader {
public:
    ValueReader(const Key& key, const std::string& source, const std::string& folder)
        : key_(key), source_(source), folder_(folder) {}

    bool is_vector() const { return key_.count > 1 || key_.kind == ValueKind::choices; }

    Value read_one(const TomlNode& node) {
        Value value;
        value.where = node.where;
        value.one_for_all = key_.one_for_all && (node.type != Type::array || node.items.size() == 1);
        if (is_vector() && node.type == Type::array)
            read_vector(node, value);
        else if (!is_vector() || value.one_for_all)
            read_part(node, value);
        else {
            if (node.type == Type::string)
                read_part(node, value); // which may be none of the list's words
            refuse(node, "{} is a list, for example {}; got {}", key_.name, key_.default_text, describe(node));
        }
        make_canonical(value);
        return value;
    }

    template <typename... Parts>
    [[noreturn]] void refuse(const TomlNode& node, fmt::format_string<Parts...> message, Parts&&... parts) const {
        fail(source_, node.where, fmt::format(message, std::forward<Parts>(parts)...));
    }

private:
    void read_vector(const TomlNode& node, Value& value) {
        if (node.items.empty())
            refuse(node, "empty list: {} needs {}", key_.name,
                   key_.count > 1 ? fmt::format("{} values", key_.count) : "at least one value");
        if (key_.kind != ValueKind::choices && !value.one_for_all && node.items.size() != key_.count)
            refuse(node, "{} takes {} values, got {}; for a sweep write a list of lists", key_.name, key_.count,
                   node.items.size());
        Errors errors;
        for (const TomlNode& item : node.items)
            errors.attempt([&] {
                read_part(item, value);
                if (key_.kind == ValueKind::choices && std::ranges::count(value.integers, value.integers.back()) > 1)
                    refuse(item, "{} is given twice in {}", describe(item), key_.name);
            });
        errors.report();
    }

    // However it is written, one meaning has one content: the first channel is always written, and their order means
    // nothing.
    void make_canonical(Value& value) const {
        if (value.one_for_all)
            value.numbers.resize(key_.count, value.numbers.front());
        if (key_.kind == ValueKind::choices) {
            value.integers.push_back(0);
            std::ranges::sort(value.integers);
            value.integers.erase(std::unique(value.integers.begin(), value.integers.end()), value.integers.end());
        }
    }

    void read_part(const TomlNode& node, Value& value) {
        value.parts.push_back(node.where);
        switch (key_.kind) {
        case ValueKind::quantity:
        case ValueKind::unit:
            read_quantity(node, value);
            break;
        case ValueKind::number:
            return read_number(node, value);
        case ValueKind::integer:
            return read_integer(node, value);
        case ValueKind::choice:
        case ValueKind::choices:
            read_choice(node, value);
            break;
        case ValueKind::file:
            read_file(node, value);
            break;
        case ValueKind::digest:
            check_digest(node);
            break;
        case ValueKind::text:
            check_text(node);
            break;
        case ValueKind::boolean:
            if (node.type != Type::boolean)
                refuse(node, "{} is true or false, without quotes; got {}", key_.name, describe(node));
            value.integers.push_back(node.truth ? 1 : 0);
        }
        value.texts.push_back(node.text);
    }

    // Or a unit: "mm", or as much of it as 1 means: "25 mm".
    void read_quantity(const TomlNode& node, Value& value) {
        const DimensionInfo& info = dimension_info(key_.dimension);
        const bool is_unit = key_.kind == ValueKind::unit;
        if (is_unit && node.type != Type::string)
            refuse(node, "{} is the name of {} unit in quotes, for example \"mm\"; got {}", key_.name,
                   info.with_article, describe(node));
        if (!is_unit && is_number(node))
            refuse(node, "{} needs a unit: write {}", key_.name, with_units(node));
        if (node.type != Type::string)
            refuse(node, "{} is {} with a unit, for example \"{}\"; got {}", key_.name, info.with_article, info.example,
                   describe(node));
        const bool has_number =
            !node.text.empty() && (node.text.front() == '.' || (node.text.front() >= '0' && node.text.front() <= '9'));
        double number = 0;
        try {
            number = parse_quantity(is_unit && !has_number ? "1 " + node.text : node.text, key_.dimension);
        } catch (const UsageError& error) {
            fail(source_, node.where, error.what());
        }
        if (key_.sign == Sign::positive && !(number > 0))
            refuse(node, "{} must be positive, got {}", key_.name, node.text);
        if (key_.sign == Sign::not_negative && !(number >= 0))
            refuse(node, "{} must not be negative, got {}", key_.name, node.text);
        value.numbers.push_back(number);
    }

    // A number, or a text that holds no more.
    static bool is_number(const TomlNode& node) {
        if (node.type != Type::string)
            return node.type == Type::integer || (node.type == Type::real && std::isfinite(node.real));
        return number_in<double>(node.text).has_value();
    }

    // The number with the units that may have been meant: that of the default, that of the example, and SI's.
    std::string with_units(const TomlNode& node) const {
        const DimensionInfo& info = dimension_info(key_.dimension);
        std::vector<std::string> all;
        const auto add = [&](std::string_view unit) {
            add_once(fmt::format("\"{} {}\"", node.type == Type::string ? node.text : describe(node), unit), all);
        };
        if (const std::size_t number = key_.default_text.find_first_of("0123456789");
            number != std::string_view::npos) {
            const std::string_view quantity = key_.default_text.substr(number);
            const std::size_t blank = std::min(quantity.find(' '), quantity.size() - 1);
            add(quantity.substr(blank + 1, quantity.find('"') - blank - 1));
        }
        add(info.example.substr(info.example.find(' ') + 1));
        add(info.unit);
        return fmt::format("{}{}{}", fmt::join(all.begin(), all.end() - 1, ", "), all.size() > 1 ? " or " : "",
                           all.back());
    }

    void read_number(const TomlNode& node, Value& value) {
        if (node.type == Type::string && is_number(node))
            refuse(node, "{} is a number: write {}, without quotes", key_.name, node.text);
        if (node.type != Type::integer && node.type != Type::real)
            refuse(node, "{} is a number without quotes; got {}", key_.name, describe(node));
        const double number = node.type == Type::integer ? static_cast<double>(node.integer) : node.real;
        if (!std::isfinite(number) || (key_.sign == Sign::positive && !(number > 0)) ||
            (key_.sign == Sign::not_negative && !(number >= 0)))
            refuse(node, "{} must be {}, got {}", key_.name,
                   key_.sign == Sign::positive       ? "positive and finite"
                   : key_.sign == Sign::not_negative ? "finite and not negative"
                                                     : "finite",
                   number);
        value.numbers.push_back(number);
        value.texts.push_back(fmt::format("{}", number));
    }

    void read_integer(const TomlNode& node, Value& value) {
        const auto is_whole = [](double number) { return number == std::floor(number) && std::abs(number) < 1e15; };
        if (node.type == Type::real && is_whole(node.real))
            refuse(node, "{} is a whole number: write {:.0f}, without a point", key_.name, node.real);
        if (node.type == Type::string && !node.text.empty() &&
            node.text.find_first_not_of("0123456789") == std::string::npos)
            refuse(node, "{} is a whole number: write {}, without quotes", key_.name, node.text);
        if (node.type != Type::integer)
            refuse(node, "{} is a whole number without quotes; got {}", key_.name, describe(node));
        if (node.integer < 0 || static_cast<std::uint64_t>(node.integer) < key_.smallest ||
            static_cast<std::uint64_t>(node.integer) > key_.largest)
            refuse(node, "{} must be from {} to {}, got {}", key_.name, key_.smallest, key_.largest, node.integer);
        value.integers.push_back(static_cast<std::uint64_t>(node.integer));
        value.texts.push_back(fmt::format("{}", node.integer));
    }

    // "crease:30 deg", a choice with an angle.
    void read_angle_of_choice(const TomlNode& node, std::string_view choice, Value& value) {
        const std::string angle = node.text.substr(choice.find(':') + 1);
        try {
            value.numbers.push_back(parse_quantity(angle, Dimension::angle));
        } catch (const UsageError& error) {
            refuse(node, "{} is a name and an angle, as \"{}\": {}", key_.name, choice, error.what());
        }
        if (!(value.numbers.back() >= 0) || value.numbers.back() > M_PI)
            refuse(node, "{}: the angle of {} must be from 0 to 180 deg, got {}", key_.name,
                   choice.substr(0, choice.find(':')), angle);
    }

    void read_choice(const TomlNode& node, Value& value) {
        const std::string all = fmt::format("{} is one of {}", key_.name, fmt::join(key_.choices, ", "));
        if (node.type != Type::string)
            refuse(node, "{}, in quotes; got {}", all, describe(node));
        const auto found = std::ranges::find_if(key_.choices, [&](std::string_view choice) {
            const std::size_t colon = choice.find(':');
            return colon == std::string_view::npos ? choice == node.text
                                                   : node.text.starts_with(choice.substr(0, colon + 1));
        });
        if (found != key_.choices.end() && found->find(':') != std::string_view::npos) {
            read_angle_of_choice(node, *found, value);
        } else if (found == key_.choices.end()) {
            const std::vector<std::string> names(key_.choices.begin(), key_.choices.end());
            const std::string meant = did_you_mean(node.text, names);
            refuse(node, "{}; got {}{}", all, describe(node), meant.empty() ? hint_for(key_.path(), node.text) : meant);
        }
        value.integers.push_back(static_cast<std::uint64_t>(found - key_.choices.begin()));
    }

    void read_file(const TomlNode& node, Value& value) {
        if (node.type != Type::string)
            refuse(node, "{} is the name of a file, in quotes; got {}", key_.name, describe(node));
        const std::string name = base_name(node.text);
        if (!node.text.empty() && (name.empty() || name == "." || name == ".."))
            refuse(node, "{} is a folder; {} is the name of a file", describe(node), key_.name);
        if (name.empty() || node.text.find('\0') != std::string::npos)
            refuse(node, "{} names no file", describe(node));
        value.place = location_prefix(source_, node.where);
        value.place.resize(value.place.size() - std::string_view(": ").size());
        value.path =
            (std::filesystem::absolute(folder_.empty() ? "." : folder_) / node.text).lexically_normal().string();
    }

    void check_text(const TomlNode& node) const {
        if (node.type != Type::string || node.text.empty())
            refuse(node, "{} is a text in quotes; got {}", key_.name, describe(node));
        if (node.text.size() > kLongestText)
            refuse(node, "{} is longer than {} characters", key_.name, kLongestText);
    }

    void check_digest(const TomlNode& node) const {
        const auto is_hex = [](char c) { return (c >= '0' && c <= '9') || (c >= 'a' && c <= 'f'); };
        if (node.type != Type::string || node.text.size() != 64 || !std::ranges::all_of(node.text, is_hex))
            refuse(node, "{} is 64 lower-case hexadecimal digits in quotes, as sha256sum prints them", key_.name);
    }

    const Key& key_;
    const std::string& source_;
    const std::string& folder_;
};

} // namespace

std::string identity(const Value& value) {
    std::string result;
    for (const double number : value.numbers)
        result += fmt::format("{:x},", std::bit_cast<std::uint64_t>(number));
    for (const std::uint64_t integer : value.integers)
        result += fmt::format("{},", integer);
    return result + base_name(value.path);
}

std::string plain_text(const Value& value, char separator) {
    return fmt::format("{}", fmt::join(value.texts, std::string_view(&separator, 1)));
}

std::string literal(const Key& key, const Value& value) {
    std::vector<std::string> parts;
    for (const std::string& text : value.texts)
        parts.push_back(key.kind == ValueKind::integer || key.kind == ValueKind::number ? text
                        : key.kind == ValueKind::file                                   ? toml_string(base_name(text))
                                                                                        : toml_string(text));
    if (value.one_for_all || (key.count == 1 && key.kind != ValueKind::choices))
        return parts.front();
    return fmt::format("[{}]", fmt::join(parts, ", "));
}

std::vector<Value> read_values(const Key& key, const TomlNode& node, const std::string& source,
                               const std::string& folder) {
    ValueReader reader(key, source, folder);
    // For a key that is a list itself, only a list of lists is an axis.
    const auto is_array = [](const TomlNode& item) { return item.type == Type::array; };
    if (!is_array(node) || (!key.axis && key.kind != ValueKind::digest) ||
        (reader.is_vector() && std::ranges::none_of(node.items, is_array)))
        return {reader.read_one(node)};
    if (node.items.empty())
        reader.refuse(node, "empty list: {} needs at least one value", key.name);
    std::vector<Value> values;
    Errors errors;
    for (const TomlNode& item : node.items) {
        errors.attempt([&] {
            if (is_array(item) && !reader.is_vector())
                reader.refuse(item, "a sweep axis of {} is a list of single values; got a list in it", key.name);
            values.push_back(reader.read_one(item));
        });
        if (errors.enough())
            break;
    }
    errors.report();
    return values;
}

} // namespace forceshade
