#include "host/scene/document.h"

#include <algorithm>
#include <array>

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <toml++/toml.h>

#include "host/scene/schema.h"
#include "host/scene/value.h"

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

// "[surface] or [texture]": the tables that have a key of this name.
std::string tables_with(std::string_view name) {
    std::vector<std::string> tables;
    for (const Key& key : schema_keys())
        if (key.name == name)
            tables.push_back(fmt::format("[{}]", key.table));
    return fmt::format("{}", fmt::join(tables, " or "));
}

class LayerReader {
public:
    LayerReader(const std::string& source, const std::string& folder) : source_(source), folder_(folder) {}

    Layer read(const TomlNode& node) {
        layer_.where = node.where;
        for (const TomlMember& member : node.members)
            read_table(member);
        fold_digests();
        return std::move(layer_);
    }

    void read_entry(std::size_t index, const TomlMember& member) {
        const Key& key = schema_keys()[index];
        for (const Entry& entry : layer_.entries)
            if (replaces(index, entry.key))
                fail(source_, member.where, "give \"{}\" or \"{}\", not both",
                     schema_keys()[std::min(index, entry.key)].name, schema_keys()[std::max(index, entry.key)].name);
        layer_.entries.push_back({index, read_values(key, member.value, source_, folder_), member.where});
    }

private:
    void read_table(const TomlMember& member) {
        const std::vector<std::string> tables = names_in(&Key::table);
        if (std::ranges::find(tables, member.key) == tables.end())
            refuse_table(member, tables);
        if (member.value.type != Type::table)
            fail(source_, member.where, "[{}] is a table of keys; got {}", member.key, describe(member.value));
        layer_.tables.insert(member.key);
        for (const TomlMember& item : member.value.members)
            read_item(member.key, "", item);
    }

    // A table within a table gives keys with a dot in their name.
    void read_item(const std::string& table, const std::string& prefix, const TomlMember& item) {
        if (item.key.find('.') != std::string::npos)
            refuse_key(item, table);
        const TomlMember named{prefix + item.key, item.where, item.value};
        const int key = find_key(table + '.' + named.key);
        const bool is_table = item.value.type == Type::table, has_parts = is_table_of_parts(table, named.key);
        if (has_parts && !is_table && key < 0)
            fail(source_, item.where, "{} is a table, for example {}; got {}", named.key,
                 named.key == "transform" ? "{ scale = 2, translate = [\"1 mm\", \"0 m\", \"0 m\"] }"
                                          : "{ amplitude = \"0.1 mm\", frequency = \"10 Hz\" }",
                 describe(item.value));
        if (!has_parts || !is_table) {
            if (key < 0)
                refuse_key(named, table);
            return read_entry(static_cast<std::size_t>(key), named);
        }
        if (item.value.members.empty())
            fail(source_, item.where, "{} is a table without a key", named.key);
        for (const TomlMember& part : item.value.members)
            read_item(table, named.key + '.', part);
    }

    // Whether keys begin with this name and a dot.
    static bool is_table_of_parts(std::string_view table, const std::string& name) {
        return std::ranges::any_of(
            schema_keys(), [&](const Key& key) { return key.table == table && key.name.starts_with(name + '.'); });
    }

    [[noreturn]] void refuse_table(const TomlMember& member, std::vector<std::string> tables) const {
        if (member.key == kVariant)
            fail(source_, member.where,
                 "variants stand at the top of the file, each as [[variant]], with two brackets");
        const std::string with = tables_with(member.key);
        if (!with.empty())
            fail(source_, member.where, "\"{}\" stands in no table; it belongs in {}", member.key, with);
        tables.insert(tables.end(), {std::string(kVariant), std::string(kExperiment)});
        const std::string_view near = nearest(member.key, tables);
        const std::string hint = near.empty() ? fmt::format("known are [{}]", fmt::join(tables, "], ["))
                                              : fmt::format("did you mean [{}]?", near);
        const bool table = member.value.type == Type::table;
        fail(source_, member.where, "unknown {}; {}",
             table ? fmt::format("table [{}]", member.key) : fmt::format("key \"{}\"", member.key), hint);
    }

    [[noreturn]] void refuse_key(const TomlMember& member, const std::string& table) const {
        const std::vector<std::string> names = names_in(&Key::name, table);
        std::string hint = did_you_mean(member.key, names);
        if (const std::string with = tables_with(member.key); hint.empty() && !with.empty())
            hint = fmt::format("; it belongs in {}", with);
        if (hint.empty())
            hint = fmt::format("; it has {}", fmt::join(names, ", "));
        fail(source_, member.where, "unknown key \"{}\" in [{}]{}", member.key, table, hint);
    }

    // A digest is part of its file's value: one for each file of an axis.
    void fold_digests() {
        auto& entries = layer_.entries;
        for (const Entry& digest : entries) {
            const Key& key = schema_keys()[digest.key];
            if (key.kind != ValueKind::digest)
                continue;
            const auto file = std::ranges::find_if(entries, [&](const Entry& entry) {
                return schema_keys()[entry.key].kind == ValueKind::file && schema_keys()[entry.key].table == key.table;
            });
            if (file == entries.end())
                fail(source_, digest.where, "\"sha256\" needs \"file\" beside it");
            if (file->values.size() != digest.values.size())
                fail(source_, digest.where, "\"sha256\" needs one digest for each file: {} for {}",
                     digest.values.size(), file->values.size());
            for (std::size_t i = 0; i < digest.values.size(); ++i)
                file->values[i].sha256 = digest.values[i].texts.front();
        }
        std::erase_if(entries, [](const Entry& entry) { return schema_keys()[entry.key].kind == ValueKind::digest; });
    }

    const std::string& source_;
    const std::string& folder_;
    Layer layer_;
};

void read_variants(const TomlMember& member, const std::string& folder, Document& document) {
    const auto is_table = [](const TomlNode& item) { return item.type == Type::table; };
    const auto& items = member.value.items;
    if (member.value.type != Type::array || items.empty() || !std::ranges::all_of(items, is_table))
        fail(document.source, member.where, "variants are tables, each written as [[variant]], with two brackets");
    for (const TomlNode& item : items)
        document.variants.push_back(LayerReader(document.source, folder).read(item));
}

// An override's value as TOML would have it: a list or an integer as it stands, everything else as a string.
TomlMember override_member(const Key& key, const std::string& text, const std::string& source) {
    TomlMember member;
    if (text.starts_with('[') || key.kind == ValueKind::integer) {
        TomlNode root = parse_toml("value = " + text, source);
        if (root.members.size() != 1)
            fail(source, {}, "\"{}\" is not one value", text);
        member.value = std::move(root.members.front().value);
    } else {
        member.value.type = Type::string;
        member.value.text = text;
    }
    member.value.where = {};
    for (TomlNode& item : member.value.items)
        item.where = {};
    return member;
}

Layer read_overrides(std::span<const Override> overrides, const std::string& folder) {
    Layer layer;
    for (const auto& [path, text] : overrides) {
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
        layer.tables.emplace(key.table);
        std::erase_if(layer.entries, [&](const Entry& e) { return e.key == number || replaces(number, e.key); });
        layer.entries.push_back(
            {number, read_values(key, override_member(key, text, source).value, source, folder), {}});
    }
    return layer;
}

std::vector<Entry> read_defaults() {
    std::vector<Entry> entries;
    for (std::size_t i = 0; i < schema_keys().size(); ++i) {
        const Key& key = schema_keys()[i];
        Entry entry{i, {}, {}};
        if (!key.default_text.empty()) {
            const TomlNode root = parse_toml(fmt::format("value = {}", key.default_text), key.path());
            entry.values = read_values(key, root.members.front().value, key.path(), "");
            for (Value& value : entry.values) {
                value.where = {};
                std::ranges::fill(value.parts, Location{});
            }
        }
        entries.push_back(std::move(entry));
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
    return std::ranges::any_of(layers(), [&](const Layer* layer) { return layer->has(table); });
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
                       std::span<const std::pair<std::string, std::string>> overrides) {
    Document document;
    document.source = source;
    TomlNode root = parse_toml(text, source);
    const auto variant =
        std::ranges::find_if(root.members, [](const TomlMember& member) { return member.key == kVariant; });
    if (variant != root.members.end()) {
        read_variants(*variant, folder, document);
        root.members.erase(variant);
    }
    const auto experiment =
        std::ranges::find_if(root.members, [](const TomlMember& member) { return member.key == kExperiment; });
    if (experiment != root.members.end()) {
        document.experiment = std::make_shared<const TomlNode>(std::move(experiment->value));
        root.members.erase(experiment);
    }
    document.base = LayerReader(document.source, folder).read(root);
    document.overrides = read_overrides(overrides, folder);
    document.order = key_order(document);
    return document;
}

namespace {

constexpr int kMostKeyDots = 32;
constexpr int kDeepest = 16;

Location location(const toml::source_position& position) {
    return {position.line, position.column};
}

// Behind the last quote of the quoted text that begins at `at`, or where it breaks off.
std::size_t end_of_quoted(std::string_view text, std::size_t at) {
    const std::string quotes(3, text[at]);
    const bool multi_line = text.substr(at, 3) == quotes;
    const std::size_t width = multi_line ? 3 : 1;
    for (std::size_t i = at + width; i < text.size(); ++i) {
        if (text[i] == '\n' && !multi_line)
            return i;
        if (text[i] == '\\' && text[at] == '"') {
            ++i;
        } else if (text.substr(i, width) == quotes.substr(0, width)) {
            for (i += width; multi_line && text.substr(i, 1) == quotes.substr(0, 1);) // up to two belong to the text
                ++i;
            return i;
        }
    }
    return text.size();
}

Location location_in(std::string_view text, std::size_t at) {
    const std::string_view before = text.substr(0, at), line = text.substr(before.rfind('\n') + 1);
    const auto begins_character = [](char c) { return (static_cast<unsigned char>(c) & 0xC0) != 0x80; };
    const std::size_t length = at - (text.size() - line.size());
    return {static_cast<std::uint32_t>(1 + std::ranges::count(before, '\n')),
            static_cast<std::uint32_t>(1 + std::ranges::count_if(line.substr(0, length), begins_character))};
}

// The TOML library recurses once a level when it frees a table, so a key of a hundred thousand dots would end the
// stack. Dots count while they may belong to one dotted key; what stands in quotes or in a comment ends none.
void refuse_deep_keys(std::string_view text, const std::string& source) {
    int dots = 0;
    for (std::size_t at = 0; at < text.size();) {
        const char c = text[at];
        if (c == '"' || c == '\'') {
            at = end_of_quoted(text, at);
            continue;
        }
        if (c == '#') {
            at = std::min(text.find('\n', at), text.size());
            continue;
        }
        if (c == '\n' || c == ',' || c == '=')
            dots = 0;
        if (c == '.' && ++dots > kMostKeyDots)
            fail(source, location_in(text, at), "a key of so many dots is none of this schema's");
        ++at;
    }
}

TomlNode convert(const toml::node& node, const std::string& source, int depth);

void convert_members(const toml::table& table, TomlNode& result, const std::string& source, int depth) {
    for (const auto& [key, value] : table)
        result.members.push_back(
            {std::string(key.str()), location(key.source().begin), convert(value, source, depth + 1)});
    std::ranges::sort(result.members, [](const TomlMember& a, const TomlMember& b) { return a.where < b.where; });
}

TomlNode convert(const toml::node& node, const std::string& source, int depth) {
    TomlNode result;
    result.where = location(node.source().begin);
    if (depth > kDeepest)
        fail(source, result.where, "tables or lists nested this deep are none of this schema's");
    if (const auto* table = node.as_table()) {
        convert_members(*table, result, source, depth);
    } else if (const auto* array = node.as_array()) {
        result.type = TomlNode::Type::array;
        for (const toml::node& item : *array)
            result.items.push_back(convert(item, source, depth + 1));
    } else if (const auto* string = node.as_string()) {
        result.type = TomlNode::Type::string;
        result.text = string->get();
    } else if (const auto* integer = node.as_integer()) {
        result.type = TomlNode::Type::integer;
        result.integer = integer->get();
    } else if (const auto* real = node.as_floating_point()) {
        result.type = TomlNode::Type::real;
        result.real = real->get();
    } else if (const auto* boolean = node.as_boolean()) {
        result.type = TomlNode::Type::boolean;
        result.truth = boolean->get();
    } else {
        result.type = TomlNode::Type::date;
    }
    return result;
}

} // namespace

std::string describe(const TomlNode& node) {
    if (node.type == TomlNode::Type::string)
        return toml_string(node.text);
    if (node.type == TomlNode::Type::integer)
        return fmt::format("{}", node.integer);
    if (node.type == TomlNode::Type::real)
        return fmt::format("{}", node.real);
    return std::array{
        "", "", "", "a boolean", "a date or time", "a list", "a table"}[static_cast<std::size_t>(node.type)];
}

TomlNode parse_toml(std::string_view text, const std::string& source) {
    if (text.size() > kLargestToml)
        fail(source, {}, "it is no scene or study: it has more than {} bytes", kLargestToml);
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF"))
        fail(source, {1, 1}, "the text is UTF-16; save it as UTF-8");
    refuse_deep_keys(text, source);
    try {
        return convert(toml::parse(text, std::string_view(source)), source, 0);
    } catch (const toml::parse_error& error) {
        fail(source, location(error.source().begin), std::string(error.description()));
    }
}

std::string toml_string(std::string_view text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            result += '\\';
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
        else
            result += c;
    }
    return result + '"';
}

} // namespace forceshade
