// A scene or study as read: a base layer, variants over it, and overrides on top, checked key by key against the
// schema.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <initializer_list>
#include <memory>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include "host/scene/toml.h"
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

using Tables = std::set<std::string, std::less<>>;

struct Layer {
    Location where;
    std::vector<Entry> entries; // in file order
    Tables tables; // that are given, be it empty: without [texture], [paths], [hand] or [grid] a scene is another one

    const Entry* find(std::size_t key) const;
};

struct Document {
    std::string source;
    Layer base;
    std::vector<Layer> variants;
    Layer overrides;
    std::shared_ptr<const TomlNode> experiment; // [experiment], which host/experiment reads; null: there is none
    Tables doubtful;                            // of which something was refused, and so is not here

    /// The base, the overrides, then the variants.
    std::vector<const Layer*> layers() const;

    /// Whether any layer has the table.
    bool has(std::string_view table) const;

    /// Whether all that was said of these tables is here: what is wrong with them as a whole can be told.
    bool sure_of(std::initializer_list<std::string_view> tables) const;

    /// Keys given anywhere, in the order in which names and axes list them: tables by their first key, keys by their
    /// first place, the base and overrides before the variants. `function` and `file` share a place, since one stands
    /// for the other.
    std::vector<std::size_t> order;
};

/// `overrides`: paths of keys ("run.precision") and values as text, without quotes unless in a list.
/// What is wrong is added to `errors` and left out of the result. File names are relative to `folder`.
Document read_document(std::string_view text, const std::string& source, const std::string& folder,
                       std::span<const std::pair<std::string, std::string>> overrides, Errors& errors);

/// Document::order: the same for a document and for its resolved text.
std::vector<std::size_t> key_order(const Document& document);

/// The default of each key of the schema, by key; no values where it has none.
const std::vector<Entry>& default_entries();

/// True for two keys of a table that each replace the other, such as `function` and `file`.
bool replaces(std::size_t key, std::size_t other);

} // namespace forceshade
