#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "host/scene/cases.h"
#include "host/scene/document.h"
#include "host/scene/schema.h"
#include "host/scene/study.h"

namespace forceshade {

namespace {

void add_to_order(std::size_t key, std::vector<std::size_t>& order) {
    add_once(key, order);
    for (std::size_t other = 0; other < schema_keys().size(); ++other)
        if (replaces(key, other))
            add_once(other, order);
}

// A function or file that only variants give comes first in its table: the resolved text may not be able to mention it
// in its base, which lists every other key. A texture shows in names by its function, even if it is all defaults.
void add_function_of_variants(std::string_view table, const std::vector<const Layer*>& layers,
                              std::vector<std::size_t>& order) {
    const int function = find_key(fmt::format("{}.function", table));
    if (function < 0)
        return;
    const auto key = static_cast<std::size_t>(function);
    const auto gives = [key](const Layer* layer) {
        const auto same = [key](const Entry& entry) { return entry.key == key || replaces(key, entry.key); };
        return std::ranges::any_of(layer->entries, same);
    };
    const auto variants = layers.begin() + 2; // after the base and the overrides
    const bool wanted = table == "texture" || std::any_of(variants, layers.end(), gives);
    if (wanted && std::none_of(layers.begin(), variants, gives))
        add_to_order(key, order);
}

// False for a key without a default that only variants give: the resolved text's base cannot mention it. Those that
// replace each other share a place.
bool may_stand_in_base(std::size_t key, const Document& document) {
    for (std::size_t other = 0; other < schema_keys().size(); ++other)
        if ((other == key || replaces(key, other)) &&
            (!schema_keys()[other].default_text.empty() || document.base.find(other) || document.overrides.find(other)))
            return true;
    return false;
}

} // namespace

std::vector<std::size_t> key_order(const Document& document) {
    const std::vector<const Layer*> layers = document.layers();
    std::vector<std::string_view> tables;
    for (const Layer* layer : layers)
        for (const Entry& entry : layer->entries)
            add_once(schema_keys()[entry.key].table, tables);
    for (const std::string_view table : {"texture", "compare", "friction"})
        if (document.has(table))
            add_once(table, tables);
    // A table without which a scene is another one comes last if only variants have it: the resolved text cannot
    // mention it in its base.
    const auto in_base = [&](std::string_view table) {
        const auto has = [&](std::string_view one) {
            return document.base.tables.contains(one) || document.overrides.tables.contains(one);
        };
        if (table == "grid")
            return has(table) || !document.has("paths");
        return has(table) || (table != "texture" && table != "paths" && table != "compare" && table != "friction" &&
                              (table != "hand" || has("paths")));
    };
    std::stable_partition(tables.begin(), tables.end(), in_base);
    std::vector<std::size_t> order;
    for (const std::string_view table : tables) {
        const std::size_t begin = order.size();
        add_function_of_variants(table, layers, order);
        for (const Layer* layer : layers)
            for (const Entry& entry : layer->entries)
                if (schema_keys()[entry.key].table == table)
                    add_to_order(entry.key, order);
        if (table == "paths")
            std::stable_partition(order.begin() + static_cast<std::ptrdiff_t>(begin), order.end(),
                                  [&](std::size_t key) { return may_stand_in_base(key, document); });
    }
    return order;
}

namespace {

// Appends `key = value`, under a table header wherever the table changes; in a variant `table.key = value`.
class TomlWriter {
public:
    void add(std::string_view table, std::string_view name, std::string_view literal) {
        if (table != table_ && !in_variant_) {
            text_ += fmt::format("{}[{}]\n", text_.empty() ? "" : "\n", table);
            table_ = table;
        }
        text_ += fmt::format("{}{}{} = {}\n", in_variant_ ? table : "", in_variant_ ? "." : "", name, literal);
    }
    void begin_variant() {
        text_ += text_.empty() ? "[[variant]]\n" : "\n[[variant]]\n";
        in_variant_ = true;
    }
    // In a variant, a table of which no key is said.
    void add_empty(std::string_view table) { text_ += fmt::format("{} = {{}}\n", table); }

    std::string text() { return std::move(text_); }

private:
    std::string text_;
    std::string_view table_;
    bool in_variant_ = false;
};

// "u.exr" -> digest, of the files whose digest is known.
using Digests = std::map<std::string, std::string>;

Digests known_digests(const Study& study) {
    Digests digests;
    for (const Case& one : study.cases)
        for (const auto& [key, file] : files_of(one.scene))
            if (!file->sha256.empty())
                digests[file->path] = file->sha256;
    return digests;
}

bool is_mesh(const Forms& forms) {
    return forms.surface == kFormMesh;
}

// One value, or a list of them.
std::string axis_literal(const std::vector<std::string>& values) {
    return values.size() == 1 ? values.front() : fmt::format("[{}]", fmt::join(values, ", "));
}

std::string literal(const Key& key, const Entry& entry) {
    std::vector<std::string> values;
    for (const Value& value : entry.values) {
        // In an axis of a key that is a list itself, a value that stands for all components needs brackets of its own.
        const std::string text = literal(key, value);
        values.push_back(value.one_for_all && entry.values.size() > 1 ? fmt::format("[{}]", text) : text);
    }
    // An axis of one vector must not look like a vector of vectors.
    return axis_literal(values);
}

class StudyPrinter {
public:
    explicit StudyPrinter(const Study& study)
        : document_(*study.document), digests_(known_digests(study)),
          base_(merge({&document_.base, &document_.overrides})), stacks_(stacks_of(document_)) {
        for (const Stack& stack : stacks_)
            forms_.insert(forms_.end(), stack.forms.begin(), stack.forms.end());
    }

    std::string print() {
        for (const std::size_t key : base_order())
            if (const Entry* entry = base_.entries[key]; entry && belongs_in_base(key))
                print(*entry);
        for (const Stack& stack : stacks_)
            if (stack.variant)
                print_variant(*stack.variant, stack.forms);
        return writer_.text();
    }

private:
    // Those that share a group come together, at the place of the first.
    template <typename Group>
    static std::vector<std::size_t> grouped(const std::vector<std::size_t>& order, const Group& group) {
        std::vector<std::size_t> result;
        for (const std::size_t first : order)
            for (const std::size_t key : order)
                if (group(key) == group(first))
                    add_once(key, result);
        return result;
    }

    // The order of names first, so that reading it back gives the same names; tables stay together.
    std::vector<std::size_t> base_order() const {
        std::vector<std::size_t> order = document_.order;
        for (std::size_t key = 0; key < schema_keys().size(); ++key)
            add_once(key, order);
        // A key's table; a table within a table stays together too, as it will be read.
        const auto table = [](std::size_t key) { return schema_keys()[key].table; };
        const auto inner = [](std::size_t key) {
            const Key& info = schema_keys()[key];
            return fmt::format("{}.{}", info.table, info.name.substr(0, info.name.find('.')));
        };
        return grouped(grouped(order, inner), table);
    }

    // What some case uses, and what was given for the base's own choices, even if every variant chooses otherwise.
    bool belongs_in_base(std::size_t index) const {
        const Key& key = schema_keys()[index];
        const bool given = document_.base.find(index) || document_.overrides.find(index);
        const bool useful = applies_to_any(key, forms_) || (given && applies_to_any(key, possible_forms(base_)));
        // Paths without a grid in the text mean paths only: then its defaults must be left to be defaults.
        if (key.table == "grid" &&
            (!stands_in_base(index, given) || (document_.has("paths") && !base_.tables.contains("grid"))))
            return false;
        if (key.subject == Subject::paths || key.subject == Subject::hand)
            return useful &&
                   (base_.tables.contains("paths") || (base_.tables.contains("hand") && key.subject == Subject::hand));
        // A default in the text would give cases with a vibration alone a height map.
        if (!given && key.subject == Subject::texture && !(key.forms & kFormVibration) &&
            std::ranges::any_of(forms_, [](const Forms& one) { return one.texture == kFormVibration; }))
            return false;
        return useful && ((key.table != "texture" && key.table != "compare" && key.table != "friction") ||
                          base_.tables.contains(key.table));
    }

    // Where a mesh's grid may be made from its box, what was given last applies: defaults are then not written.
    bool stands_in_base(std::size_t index, bool given) const {
        const bool fits = grid_fits_mesh(base_);
        if (index == samples_)
            return fits && (given || std::ranges::all_of(forms_, is_mesh));
        if (fits && std::ranges::all_of(forms_, is_mesh))
            return false;
        return given || !fits || std::ranges::none_of(forms_, is_mesh);
    }

    // Overrides go into the base: what a variant says of their keys, or of samples beside the grid, must not replace
    // them.
    bool is_overridden(std::size_t key) const {
        return std::ranges::any_of(document_.overrides.entries, [&](const Entry& entry) {
            return entry.key == key || replaces(entry.key, key) ||
                   (key == samples_ && schema_keys()[entry.key].table == "grid");
        });
    }

    void print(const Entry& entry) {
        const Key& key = schema_keys()[entry.key];
        writer_.add(key.table, key.name, literal(key, entry));
        if (const std::string digest = digest_literal(entry); !digest.empty())
            writer_.add(key.table, digest_name(key.name), digest);
    }

    void print_variant(const Layer& variant, const std::vector<Forms>& forms) {
        writer_.begin_variant();
        std::set<std::string_view> printed; // tables
        for (const Entry& entry : variant.entries) {
            const Key& key = schema_keys()[entry.key];
            if (is_overridden(entry.key) || !applies_to_any(key, forms))
                continue;
            const bool all_mesh = std::ranges::all_of(forms, is_mesh);
            if (key.table == "grid" && entry.key != samples_ && document_.overrides.find(samples_) && all_mesh)
                continue;
            printed.insert(key.table);
            print(entry);
        }
        const Entry* samples = document_.overrides.find(samples_);
        if (printed.contains("grid") && samples && grid_fits_mesh(base_) &&
            applies_to_any(schema_keys()[samples_], forms))
            print(*samples);
        for (const std::string_view table : {"grid", "texture", "friction", "paths", "hand", "compare"})
            if (variant.tables.contains(table) && (table != "grid" || document_.has("paths")) &&
                !printed.contains(table))
                writer_.add_empty(table);
    }

    // The digests of an entry's files, if all are known; empty for other entries.
    std::string digest_literal(const Entry& entry) const {
        std::vector<std::string> values;
        for (const Value& value : entry.values) {
            const auto known = digests_.find(value.path);
            const std::string& digest = known == digests_.end() ? value.sha256 : known->second;
            if (digest.empty())
                return "";
            values.push_back(toml_string(digest));
        }
        return axis_literal(values);
    }

    const Document& document_;
    Digests digests_;
    std::size_t samples_ = key_index("grid.samples");
    Merged base_;
    std::vector<Stack> stacks_;
    std::vector<Forms> forms_; // of all cases
    TomlWriter writer_;
};

} // namespace

std::string resolved_toml(const Case& one) {
    TomlWriter writer;
    for (const Setting& setting : one.settings) {
        writer.add(setting.table, setting.name, setting.literal);
        for (const auto& [key, file] : files_of(one.scene))
            if (key == fmt::format("{}.{}", setting.table, setting.name) && !file->sha256.empty())
                writer.add(setting.table, digest_name(setting.name), toml_string(file->sha256));
    }
    return writer.text();
}

std::string resolved_toml(const Study& study) {
    return StudyPrinter(study).print();
}

} // namespace forceshade
