// TOML text to a plain tree in file order, each node with its location. The TOML library is known to toml.cpp alone.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/errors.h"

namespace forceshade {

inline constexpr std::size_t kLargestToml = std::size_t{16} << 20; /* bytes; a study is a page or two */

struct TomlNode {
    enum class Type { string, integer, real, boolean, date, array, table };
    Type type = Type::table;
    std::string key;    // of a member of a table
    Location key_where; // where that stands
    Location where;     // of the value
    std::string text;   // of a string
    std::int64_t integer = 0;
    double real = 0;
    bool truth = false;          // of a boolean
    std::vector<TomlNode> items; // of an array, or the members of a table in file order

    /// The member of a table; null if it has none of this key.
    const TomlNode* find(std::string_view name) const;
};

/// "a table", "a boolean", `"text"`, `0.2`: how messages name what was found.
std::string describe(const TomlNode& node);

/// Parses a whole TOML document (UTF-8, with or without a byte order mark).
/// Throws UsageError `source:line:column: message` for a syntax error, a key given twice, or text that is not UTF-8.
TomlNode parse_toml(std::string_view text, const std::string& source);

/// `text` as a TOML basic string, quotes included.
std::string toml_string(std::string_view text);

} // namespace forceshade
