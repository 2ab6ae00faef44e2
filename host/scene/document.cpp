#include "host/scene/document.h"

#include <algorithm>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/scene/schema.h"
#include "host/scene/value.h"
#include "host/spelling.h"

namespace forceshade {

namespace {

using Type = TomlNode::Type;
using Override = std::pair<std::string, std::string>;

constexpr std::string_view kVariant = "variant";
constexpr std::string_view kExperiment = "experiment"; // a table of host/experiment

// The names of tables, or of the keys of one, each once.
std::vector<std::string> names_in(std::string_view Key::*name, std::string_view table = "") {
    std::vector<std::string> names;
    for (const Key& key : schema_keys())
        if (table.empty() || key.table == table)
            add_once(std::string(key.*name), names);
    return names;
}

// "[surface] or [texture]": the tables that have a key of this name; those that are given, if any is.
std::string tables_with(std::string_view name, const std::vector<std::string>& given) {
    std::vector<std::string> tables, also_given;
    for (const Key& key : schema_keys())
        if (key.name == name) {
            tables.push_back(fmt::format("[{}]", key.table));
            if (std::ranges::find(given, key.table) != given.end())
                also_given.push_back(tables.back());
        }
    return fmt::format("{}", fmt::join(also_given.empty() ? tables : also_given, " or "));
}

// Other words for a key, which no misspelling leads to.
struct OtherWord {
    std::string_view table, word, key; // an empty table: any that has the key
};
constexpr OtherWord kOtherWords[] = {{"", "type", "kind"},
                                     {"", "shape", "kind"},
                                     {"", "filename", "file"},
                                     {"", "path", "file"},
                                     {"", "image", "file"},
                                     {"surface", "mesh", "file"},
                                     {"surface", "n", "facets"},
                                     {"surface", "sides", "facets"},
                                     {"surface", "r", "radius"},
                                     {"", "k", "stiffness"},
                                     {"", "spring", "stiffness"},
                                     {"", "wavelength", "width"},
                                     {"", "amplitude", "height"},
                                     {"grid", "resolution", "spacing"},
                                     {"grid", "step", "spacing"},
                                     {"grid", "voxels", "size"},
                                     {"grid", "dimensions", "size"},
                                     {"surface", "scale", "transform.scale"},
                                     {"surface", "rotate", "transform.rotate"},
                                     {"surface", "translate", "transform.translate"},
                                     {"paths", "velocity", "speed"},
                                     {"paths", "force", "press"},
                                     {"paths", "samples", "steps"},
                                     {"paths", "frequency", "rate"},
                                     {"hand", "friction", "coulomb"},
                                     {"friction", "mu", "coefficient"},
                                     {"friction", "kinetic", "coefficient"},
                                     {"friction", "static", "static_coefficient"},
                                     {"output", "format", "pixel"}};

std::string did_you_mean_by_another_word(const std::string& word, std::string_view table) {
    for (const OtherWord& one : kOtherWords)
        if (one.word == lower_case(word) && (one.table.empty() || one.table == table) &&
            find_key(fmt::format("{}.{}", table, one.key)) >= 0)
            return fmt::format("; did you mean \"{}\"?", one.key);
    return "";
}

// The key of another table that is nearest.
std::string did_you_mean_elsewhere(std::string_view word) {
    const std::vector<std::string> names = names_in(&Key::name);
    const std::string_view found = nearest(word, names);
    return found.empty() ? "" : fmt::format("; did you mean \"{}\" in {}?", found, tables_with(found, {}));
}

// What is wrong goes to `errors`, and its table into the document's doubtful ones.
class LayerReader {
public:
    LayerReader(Document& document, const std::string& folder, Errors& errors)
        : source_(document.source), folder_(folder), doubtful_(document.doubtful), errors_(errors) {}

    Layer read(const TomlNode& node) {
        layer_.where = node.where;
        for (const TomlNode& member : node.items)
            given_.push_back(member.key);
        for (const TomlNode& member : node.items)
            if (!errors_.attempt([&] { read_table(member); }))
                doubtful_.insert(std::string(meant_table(member)));
        fold_digests();
        return std::move(layer_);
    }

    void read_entry(std::size_t index, const TomlNode& node) {
        const Key& key = schema_keys()[index];
        for (const Entry& entry : layer_.entries)
            if (replaces(index, entry.key))
                fail(source_, node.key_where, "give \"{}\" or \"{}\", not both",
                     schema_keys()[std::min(index, entry.key)].name, schema_keys()[std::max(index, entry.key)].name);
        layer_.entries.push_back({index, read_values(key, node, source_, folder_), node.key_where});
    }

private:
    void read_table(const TomlNode& member) {
        const std::vector<std::string> tables = names_in(&Key::table);
        if (std::ranges::find(tables, member.key) == tables.end())
            refuse_table(member, tables);
        if (member.type != Type::table)
            fail(source_, member.key_where, "[{}] is a table of keys; got {}", member.key, describe(member));
        layer_.tables.insert(member.key);
        for (const TomlNode& item : member.items)
            if (!errors_.attempt([&] { read_item(member.key, item.key, item); }))
                doubtful_.insert(member.key);
    }

    // The table that somebody had in mind who wrote what is none, or who wrote a key in none.
    static std::string_view meant_table(const TomlNode& member) {
        static const std::vector<std::string> tables = names_in(&Key::table);
        return nearest(member.key, tables);
    }

    // A table within a table gives keys with a dot in their name.
    void read_item(const std::string& table, const std::string& name, const TomlNode& item) {
        if (item.key.find('.') != std::string::npos)
            refuse_key(item, item.key, table);
        const int key = find_key(table + '.' + name);
        const bool is_table = item.type == Type::table, has_parts = is_table_of_parts(table, name);
        if (has_parts && !is_table && key < 0)
            fail(source_, item.key_where, "{} is a table, for example {}; got {}", name,
                 name == "transform"  ? "{ scale = 2, translate = [\"1 mm\", \"0 m\", \"0 m\"] }"
                 : name == "coupling" ? "{ stiffness = \"5 N/mm\", damping = \"1 N s/m\" }"
                 : name == "surface"  ? "{ kind = \"sphere\", radius = \"20 mm\" }"
                                      : "{ amplitude = \"0.1 mm\", frequency = \"10 Hz\" }",
                 describe(item));
        if (!has_parts || !is_table) {
            if (key < 0)
                refuse_key(item, name, table);
            return read_entry(static_cast<std::size_t>(key), item);
        }
        if (item.items.empty())
            fail(source_, item.key_where, "{} is a table without a key", name);
        Errors errors;
        for (const TomlNode& part : item.items)
            errors.attempt([&] { read_item(table, name + '.' + part.key, part); });
        errors.report();
    }

    // Whether keys begin with this name and a dot.
    static bool is_table_of_parts(std::string_view table, const std::string& name) {
        return std::ranges::any_of(
            schema_keys(), [&](const Key& key) { return key.table == table && key.name.starts_with(name + '.'); });
    }

    [[noreturn]] void refuse_table(const TomlNode& member, std::vector<std::string> tables) const {
        if (member.key == kVariant)
            fail(source_, member.key_where,
                 "variants stand at the top of the file, each as [[variant]], with two brackets");
        const std::string with = tables_with(member.key, given_);
        if (!with.empty())
            fail(source_, member.key_where, "\"{}\" stands in no table; it belongs in {}", member.key, with);
        if (std::ranges::find(kSurfaceKinds, member.key) != kSurfaceKinds.end())
            fail(source_, member.key_where, "unknown table [{0}]; did you mean [surface] with kind = \"{0}\"?",
                 member.key);
        tables.insert(tables.end(), {std::string(kVariant), std::string(kExperiment)});
        const std::string_view near = nearest(member.key, tables);
        const std::string hint = near.empty() ? fmt::format("known are [{}]", fmt::join(tables, "], ["))
                                              : fmt::format("did you mean [{}]?", near);
        const bool table = member.type == Type::table;
        fail(source_, member.key_where, "unknown {}; {}",
             table ? fmt::format("table [{}]", member.key) : fmt::format("key \"{}\"", member.key), hint);
    }

    [[noreturn]] void refuse_key(const TomlNode& member, const std::string& name, const std::string& table) const {
        const std::vector<std::string> names = names_in(&Key::name, table);
        const std::string with = tables_with(name, given_);
        std::string hint = with.empty() ? did_you_mean(name, names) : fmt::format("; it belongs in {}", with);
        if (hint.empty())
            hint = did_you_mean_by_another_word(name, table);
        if (hint.empty())
            hint = did_you_mean_elsewhere(name);
        if (hint.empty())
            hint = fmt::format("; it has {}", fmt::join(names, ", "));
        fail(source_, member.key_where, "unknown key \"{}\" in [{}]{}", name, table, hint);
    }

    // A digest is part of its file's value: one for each file of an axis.
    void fold_digests() {
        auto& entries = layer_.entries;
        for (const Entry& digest : entries) {
            if (schema_keys()[digest.key].kind != ValueKind::digest)
                continue;
            if (!errors_.attempt([&] { fold(digest); }))
                doubtful_.insert(std::string(schema_keys()[digest.key].table));
        }
        std::erase_if(entries, [](const Entry& entry) { return schema_keys()[entry.key].kind == ValueKind::digest; });
    }

    void fold(const Entry& digest) {
        auto& entries = layer_.entries;
        const Key& key = schema_keys()[digest.key];
        const std::string file = file_name(key.name);
        const auto named = std::ranges::find_if(entries, [&](const Entry& entry) {
            return schema_keys()[entry.key].table == key.table && schema_keys()[entry.key].name == file;
        });
        if (named == entries.end() && doubtful_.contains(key.table))
            return; // it was refused
        if (named == entries.end())
            fail(source_, digest.where, "\"{}\" needs a \"{}\"", key.name, file);
        if (named->values.size() != digest.values.size())
            fail(source_, digest.where, "\"{}\" needs one digest for each file: {} for {}", key.name,
                 digest.values.size(), named->values.size());
        for (std::size_t i = 0; i < digest.values.size(); ++i)
            named->values[i].sha256 = digest.values[i].texts.front();
    }

    const std::string& source_;
    const std::string& folder_;
    Tables& doubtful_;
    Errors& errors_;
    std::vector<std::string> given_; // tables of this layer
    Layer layer_;
};

void read_variants(const TomlNode& variants, const std::string& folder, Document& document, Errors& errors) {
    const auto is_table = [](const TomlNode& item) { return item.type == Type::table; };
    if (variants.type != Type::array || variants.items.empty() || !std::ranges::all_of(variants.items, is_table))
        fail(document.source, variants.key_where,
             "variants are tables, each written as [[variant]], with two brackets");
    for (const TomlNode& item : variants.items)
        document.variants.push_back(LayerReader(document, folder, errors).read(item));
}

// A value by itself, of a default or an override, which has no place in a file.
TomlNode value_of(std::string_view text, const std::string& source, Location where = {}) {
    TomlNode root = parse_toml(fmt::format("value = {}", text), source);
    if (root.items.size() != 1)
        fail(source, {}, "\"{}\" is not one value", text);
    TomlNode value = std::move(root.items.front());
    value.where = where;
    for (TomlNode& item : value.items)
        item.where = where;
    return value;
}

void read_override(const Override& override, const std::string& folder, Layer& layer) {
    constexpr Location kOverride{0, 1};
    const auto& [path, text] = override;
    const std::string source = "override " + path;
    const int index = find_key(path);
    if (index < 0 || schema_keys()[static_cast<std::size_t>(index)].kind == ValueKind::digest) {
        std::vector<std::string> paths;
        for (const Key& key : schema_keys())
            paths.push_back(key.path());
        fail(source, {}, "unknown key \"{}\"{}", path, did_you_mean(path, paths));
    }
    const Key& key = schema_keys()[static_cast<std::size_t>(index)];
    const auto number = static_cast<std::size_t>(index);
    // A list or an integer is given as TOML has it, everything else without quotes.
    const bool plain = !text.starts_with('[') && key.kind != ValueKind::integer;
    TomlNode node;
    if (plain)
        node.type = Type::string, node.text = text, node.where = kOverride;
    else
        node = value_of(text, source, kOverride);
    layer.tables.emplace(key.table);
    std::erase_if(layer.entries, [&](const Entry& e) { return e.key == number || replaces(number, e.key); });
    layer.entries.push_back({number, read_values(key, node, source, folder), {}});
}

std::vector<Entry> read_defaults() {
    std::vector<Entry> entries;
    for (const Key& key : schema_keys()) {
        Entry& entry = entries.emplace_back(Entry{entries.size(), {}, {}});
        if (!key.default_text.empty())
            entry.values = read_values(key, value_of(key.default_text, key.path()), key.path(), "");
    }
    return entries;
}

} // namespace

std::vector<const Layer*> Document::layers() const {
    std::vector<const Layer*> result{&base, &overrides};
    for (const Layer& variant : variants)
        result.push_back(&variant);
    return result;
}

bool Document::has(std::string_view table) const {
    return std::ranges::any_of(layers(), [&](const Layer* layer) { return layer->tables.contains(table); });
}

bool Document::sure_of(std::initializer_list<std::string_view> tables) const {
    return !doubtful.contains("") &&
           std::ranges::none_of(tables, [&](std::string_view table) { return doubtful.contains(table); });
}

const Entry* Layer::find(std::size_t key) const {
    const auto found = std::ranges::find(entries, key, &Entry::key);
    return found == entries.end() ? nullptr : &*found;
}

bool replaces(std::size_t key, std::size_t other) {
    const Key& a = schema_keys()[key];
    const Key& b = schema_keys()[other];
    return a.table == b.table && !a.choice.empty() && a.choice == b.choice && a.option != b.option;
}

const std::vector<Entry>& default_entries() {
    static const std::vector<Entry> entries = read_defaults();
    return entries;
}

Document read_document(std::string_view text, const std::string& source, const std::string& folder,
                       std::span<const Override> overrides, Errors& errors) {
    Document document;
    document.source = source;
    TomlNode root = parse_toml(text, source);
    if (const TomlNode* variants = root.find(kVariant))
        if (!errors.attempt([&] { read_variants(*variants, folder, document, errors); }))
            document.doubtful.emplace("");
    if (const TomlNode* experiment = root.find(kExperiment))
        document.experiment = std::make_shared<const TomlNode>(*experiment);
    std::erase_if(root.items, [](const TomlNode& one) { return one.key == kVariant || one.key == kExperiment; });
    document.base = LayerReader(document, folder, errors).read(root);
    for (const Override& override : overrides)
        if (!errors.attempt([&] { read_override(override, folder, document.overrides); }))
            document.doubtful.emplace("");
    document.order = key_order(document);
    return document;
}

} // namespace forceshade
