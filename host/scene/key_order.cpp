#include "host/scene/key_order.h"

#include "host/scene/schema.h"

#include <algorithm>

#include <fmt/format.h>

namespace forceshade {

namespace {

void add_to_order(std::size_t key, std::vector<std::size_t>& order) {
    if (std::find(order.begin(), order.end(), key) == order.end())
        order.push_back(key);
    for (std::size_t other = 0; other < schema_keys().size(); ++other)
        if (replaces(key, other) && std::find(order.begin(), order.end(), other) == order.end())
            order.push_back(other);
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
        return std::any_of(layer->entries.begin(), layer->entries.end(), same);
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
    std::vector<const Layer*> layers{&document.base, &document.overrides};
    for (const Layer& variant : document.variants)
        layers.push_back(&variant);
    std::vector<std::string_view> tables;
    for (const Layer* layer : layers)
        for (const Entry& entry : layer->entries)
            if (const auto table = schema_keys()[entry.key].table;
                std::find(tables.begin(), tables.end(), table) == tables.end())
                tables.push_back(table);
    if (std::any_of(layers.begin(), layers.end(), [](const Layer* layer) { return layer->texture; }) &&
        std::find(tables.begin(), tables.end(), "texture") == tables.end())
        tables.emplace_back("texture");
    // A table without which a scene is another one comes last if only variants have it: the resolved text cannot
    // mention it in its base.
    const bool paths = std::any_of(layers.begin(), layers.end(), [](const Layer* layer) { return layer->paths; });
    const auto in_base = [&](std::string_view table) {
        const auto has = [&](bool Layer::*flag) { return document.base.*flag || document.overrides.*flag; };
        return (table != "texture" || has(&Layer::texture)) && (table != "grid" || !paths || has(&Layer::grid)) &&
               (table != "paths" || has(&Layer::paths)) && (table != "hand" || has(&Layer::hand) || has(&Layer::paths));
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

} // namespace forceshade
