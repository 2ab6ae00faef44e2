#include "host/scene/schema.h"

#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

namespace forceshade {

namespace {

constexpr std::size_t kLineWidth = 100;

std::string type_name(const Key& key) {
    switch (key.kind) {
    case ValueKind::quantity:
        return std::string(dimension_name(key.dimension));
    case ValueKind::unit:
        return fmt::format("unit of {}", dimension_name(key.dimension));
    case ValueKind::number:
        return "number";
    case ValueKind::integer:
        return "integer";
    case ValueKind::choice:
        return "choice";
    case ValueKind::choices:
        return "list of choices";
    case ValueKind::file:
        return "file";
    case ValueKind::digest:
        return "digest";
    }
    return "";
}

// The key of a quantity that may differ from path to path; its parts follow it in the schema.
bool is_spread(const Key& key) {
    const Key* next = &key + 1;
    return next != schema_keys().data() + schema_keys().size() && !key.spread_part && next->spread_part;
}

// What may stand there: choices, a range, or a unit.
std::string describe_values(const Key& key) {
    std::string text = type_name(key);
    if (!key.choices.empty())
        text = fmt::format("{}{}", key.kind == ValueKind::choices ? "a list of " : "", fmt::join(key.choices, " | "));
    else if (key.kind == ValueKind::integer)
        text = fmt::format("integer, {} to {}", key.smallest, key.largest);
    else if (key.kind == ValueKind::quantity || key.kind == ValueKind::number)
        text += key.sign == Sign::positive ? ", positive" : key.sign == Sign::not_negative ? ", not negative" : "";
    if (is_spread(key))
        text += fmt::format("; or {{ mean, sd }}: normal{}; or {{ min, max }}: uniform",
                            key.sign == Sign::any ? "" : ", drawn again until positive");
    if (key.count > 1)
        text += fmt::format("; {}{} values", key.one_for_all ? "1 or " : "", key.count);
    return text;
}

void add_comment(std::string text, std::string& result) {
    while (text.size() > kLineWidth) {
        const std::size_t cut = text.rfind(' ', kLineWidth);
        result += fmt::format("# {}\n", text.substr(0, cut));
        text.erase(0, cut + 1);
    }
    result += fmt::format("# {}\n", text);
}

void add_key(const Key& key, std::string& result) {
    const std::string applicability = describe_applicability(key);
    add_comment(fmt::format("{}: {}", key.name, key.doc), result);
    add_comment(
        fmt::format("    {}{}", describe_values(key), applicability.empty() ? "" : fmt::format(" ({})", applicability)),
        result);
    const bool image = key.kind == ValueKind::file && key.example.empty();
    const std::string_view example = image                           ? "\"u.exr\""
                                     : key.kind == ValueKind::digest ? "\"(64 hexadecimal digits)\""
                                     : !key.example.empty()          ? key.example
                                                                     : key.default_text;
    result += fmt::format("{}{} = {}\n", applies(key, Forms{}) ? "" : "# ", key.name, example);
}

std::string table_header(std::string_view table) {
    std::string_view remark;
    if (table == "texture")
        remark = "(L8; a scene without this table has none)";
    if (table == "paths")
        remark = "(exploration paths; a scene without this table has none, one with it and without [grid] no field)";
    if (table == "hand")
        remark = "(what moves the probe along paths in closed loop)";
    return remark.empty() ? fmt::format("\n[{}]\n", table) : fmt::format("\n# [{}]    {}\n", table, remark);
}

} // namespace

std::string schema_text() {
    std::string result;
    add_comment("Every key of a scene or study, with its default. A quantity is a number with a unit in a string; "
                "units are m, mil, in, "
                "g, s, Hz, N, J, rad, deg with SI prefixes, products (\"N s/m\"), quotients and powers.",
                result);
    add_comment("A list where one value may stand is a sweep axis (for a key that is a list itself, a list of lists); "
                "axes cross. "
                "[[variant]] tables override keys (surface.kind = \"cylinder_bump\"); each is swept by itself, and a "
                "case that comes "
                "twice runs once.",
                result);
    add_comment("A line that is commented out applies to another kind or function only.", result);
    std::string_view table;
    for (const Key& key : schema_keys()) {
        if (key.table != table)
            result += table_header(key.table);
        table = key.table;
        if (!key.spread_part)
            add_key(key, result);
    }
    return result;
}

std::string schema_json() {
    nlohmann::ordered_json keys = nlohmann::ordered_json::array();
    for (const Key& key : schema_keys()) {
        nlohmann::ordered_json row{{"key", key.path()}, {"type", type_name(key)}};
        row["default"] =
            key.default_text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(std::string(key.default_text));
        if (key.kind == ValueKind::quantity) {
            row["unit"] = std::string(dimension_unit(key.dimension));
            row["sign"] = key.sign == Sign::positive       ? "positive"
                          : key.sign == Sign::not_negative ? "not_negative"
                                                           : "any";
        }
        if (key.kind == ValueKind::integer) {
            row["minimum"] = key.smallest;
            row["maximum"] = key.largest;
        }
        if (!key.choices.empty())
            row["choices"] = std::vector<std::string>(key.choices.begin(), key.choices.end());
        row["count"] = key.count;
        row["one_for_all"] = key.one_for_all;
        row["axis"] = key.axis;
        row["applies_to"] = describe_applicability(key);
        row["doc"] = std::string(key.doc);
        keys.push_back(std::move(row));
    }
    return nlohmann::ordered_json{{"keys", std::move(keys)}}.dump(2) + '\n';
}

} // namespace forceshade
