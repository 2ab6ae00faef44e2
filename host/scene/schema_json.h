// The schema as JSON, for editors and other programs.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/scene/schema.h"

namespace forceshade {

/// The row of one key.
inline nlohmann::ordered_json schema_row(const Key& key) {
    nlohmann::ordered_json row{{"key", key.path()}, {"type", type_name(key)}};
    row["default"] =
        key.default_text.empty() ? nlohmann::ordered_json() : nlohmann::ordered_json(std::string(key.default_text));
    if (key.kind == ValueKind::quantity) {
        row["unit"] = std::string(dimension_info(key.dimension).unit);
        row["sign"] = std::array{"any", "not_negative", "positive"}[static_cast<std::size_t>(key.sign)];
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
    row["values"] = describe_values(key);
    row["example"] = std::string(example_of(key));
    row["doc"] = std::string(key.doc);
    return row;
}

/// {"keys": [{"key", "type", "default", ...}]}
inline nlohmann::ordered_json schema_json() {
    nlohmann::ordered_json keys = nlohmann::ordered_json::array();
    for (const Key& key : schema_keys())
        keys.push_back(schema_row(key));
    return {{"keys", std::move(keys)}};
}

} // namespace forceshade
