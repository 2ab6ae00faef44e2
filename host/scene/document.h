// A scene or study as read: a base layer, variants over it, and overrides on top, checked key by key against the
// schema.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/scene/value.h"

namespace forceshade {

/// Adds what is not there yet.
template <typename T> void add_once(std::type_identity_t<T> one, std::vector<T>& to) {
    if (std::ranges::find(to, one) == to.end())
        to.push_back(std::move(one));
}

/// A key given in a layer. More than one value: a sweep axis.
struct Entry {
    std::size_t key = 0; // index in schema_keys()
    std::vector<Value> values;
    Location where;
};

/// The tables that are given, be it empty: without [texture], [paths], [hand] or [grid] a scene is another one.
struct GivenTables {
    std::set<std::string, std::less<>> tables;

    bool has(std::string_view table) const { return tables.contains(table); }
};

struct Layer : GivenTables {
    Location where;
    std::vector<Entry> entries; // in file order

    const Entry* find(std::size_t key) const;
};

struct TomlNode;

struct Document {
    std::string source;
    Layer base;
    std::vector<Layer> variants;
    Layer overrides;
    std::shared_ptr<const TomlNode> experiment; // [experiment], which host/experiment reads; null: there is none

    /// The base, the overrides, then the variants.
    std::vector<const Layer*> layers() const;

    /// Whether any layer has the table.
    bool has(std::string_view table) const;

    /// Keys given anywhere, in the order in which names and axes list them: tables by their first key, keys by their
    /// first place, the base and overrides before the variants. `function` and `file` share a place, since one stands
    /// for the other.
    std::vector<std::size_t> order;
};

/// `overrides`: paths of keys ("run.precision") and values as text, without quotes unless in a list.
/// Throws UsageError `source:line:column: message`. File names are relative to `folder`.
Document read_document(std::string_view text, const std::string& source, const std::string& folder,
                       std::span<const std::pair<std::string, std::string>> overrides);

/// Document::order: the same for a document and for its resolved text.
std::vector<std::size_t> key_order(const Document& document);

/// The default of each key of the schema, by key; no values where it has none.
const std::vector<Entry>& default_entries();

/// True for two keys of a table that each replace the other, such as `function` and `file`.
bool replaces(std::size_t key, std::size_t other);

// TOML text to a plain tree in file order, each node with its location. The TOML library is known to the .cpp alone.

inline constexpr std::size_t kLargestToml = std::size_t{16} << 20; /* bytes; a study is a page or two */

struct TomlMember;

struct TomlNode {
    enum class Type { string, integer, real, boolean, date, array, table };
    Type type = Type::table;
    Location where;
    std::string text; // of a string
    std::int64_t integer = 0;
    double real = 0;
    bool truth = false;              // of a boolean
    std::vector<TomlNode> items;     // of an array
    std::vector<TomlMember> members; // of a table, in file order
};

struct TomlMember {
    std::string key;
    Location where; // of the key
    TomlNode value;
};

/// "a table", "a boolean", `"text"`, `0.2`: how messages name what was found.
std::string describe(const TomlNode& node);

/// Parses a whole TOML document (UTF-8, with or without a byte order mark).
/// Throws UsageError `source:line:column: message` for a syntax error, a key given twice, or text that is not UTF-8.
TomlNode parse_toml(std::string_view text, const std::string& source);

/// `text` as a TOML basic string, quotes included.
std::string toml_string(std::string_view text);

} // namespace forceshade
