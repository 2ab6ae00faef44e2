#include "host/scene/cases.h"

#include <algorithm>
#include <array>
#include <set>

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"

namespace forceshade {

namespace {

constexpr auto kSelectors =
    std::to_array<std::string_view>({"surface.kind", "surface.function", "force.shading", "texture.function",
                                     "paths.kind", "paths.loop", "compare.surface.kind"});

// A chosen value of a selector, 0 for what has none: the index of its choice.
std::uint64_t chosen(const Selection& selection, std::string_view path) {
    const Value* value = selection[key_index(path)];
    return value ? value->integers.front() : 0;
}

std::uint32_t map_form(const Selection& selection, const std::string& table) {
    if (selection[key_index(table + ".file")])
        return kFormMapFile;
    return std::uint32_t{kFormMapCylinder} << chosen(selection, table + ".function");
}

// A vibration alone has no height map: whatever else [texture] says is of one.
std::uint32_t texture_form(const Selection& selection, const Merged& merged) {
    if (!merged.tables.contains("texture"))
        return 0;
    if (!selection[key_index("texture.vibration")])
        return map_form(selection, "texture");
    bool mapped = false;
    for (std::size_t i = 0; i < selection.size(); ++i)
        mapped = mapped || (merged.ranks[i] > 0 && schema_keys()[i].subject == Subject::texture &&
                            !(schema_keys()[i].forms & kFormVibration));
    return kFormVibration | (mapped ? map_form(selection, "texture") : 0);
}

// Of a choice of one value for each key.
Forms forms_of(const Selection& selection, const Merged& merged) {
    constexpr std::array<std::uint32_t, 4> kSurfaceForms{kFormBump, kFormCylinderBump, 0, kFormMesh};
    const auto kind = static_cast<SurfaceKind>(chosen(selection, "surface.kind"));
    Forms forms;
    forms.surface = kind == SurfaceKind::height_map ? map_form(selection, "surface")
                                                    : kSurfaceForms[static_cast<std::size_t>(kind)];
    forms.texture = texture_form(selection, merged);
    forms.friction = merged.tables.contains("friction");
    forms.reference_shading = static_cast<Shading>(chosen(selection, "force.shading")) == Shading::reference;
    forms.hand = merged.tables.contains("hand");
    forms.compare = merged.tables.contains("compare") ? 1u << chosen(selection, "compare.surface.kind") : 0;
    if (!merged.tables.contains("paths"))
        return forms;
    forms.paths = 1u << chosen(selection, "paths.kind");
    forms.closed_loop = selection[key_index("paths.loop")]
                            ? static_cast<PathLoop>(chosen(selection, "paths.loop")) == PathLoop::closed
                            : selection[key_index("paths.press")] || selection[key_index("paths.push")];
    forms.hand = forms.closed_loop; // without paths a hand is what a scene says of it, with them it is needed
    return forms;
}

} // namespace

Merged merge(std::initializer_list<const Layer*> layers) {
    Merged merged;
    for (const Entry& entry : default_entries())
        merged.entries.push_back(entry.values.empty() ? nullptr : &entry);
    merged.ranks.resize(merged.entries.size());
    int rank = 0;
    for (const Layer* layer : layers) {
        ++rank;
        if (!layer)
            continue;
        merged.tables.insert(layer->tables.begin(), layer->tables.end());
        for (const Entry& entry : layer->entries) {
            merged.entries[entry.key] = &entry;
            merged.ranks[entry.key] = rank;
            for (std::size_t other = 0; other < merged.entries.size(); ++other)
                if (replaces(entry.key, other))
                    merged.entries[other] = nullptr;
        }
    }
    return merged;
}

Selection first_values(const Merged& merged) {
    Selection selection;
    for (const Entry* entry : merged.entries)
        selection.push_back(entry ? &entry->values.front() : nullptr);
    return selection;
}

bool is_selector(std::size_t key) {
    return std::ranges::find(kSelectors, schema_keys()[key].path()) != kSelectors.end();
}

std::vector<Forms> possible_forms(const Merged& merged) {
    std::vector<Selection> selections{first_values(merged)};
    for (const std::string_view path : kSelectors) {
        const std::size_t key = key_index(path), before = selections.size();
        std::set<std::uint64_t> seen{chosen(selections.front(), path)};
        for (std::size_t i = 1; merged.entries[key] && i < merged.entries[key]->values.size(); ++i)
            if (const Value& value = merged.entries[key]->values[i]; seen.insert(value.integers.front()).second)
                for (std::size_t one = 0; one < before; ++one)
                    selections.push_back(selections[one]), selections.back()[key] = &value;
    }
    std::vector<Forms> result;
    for (const Selection& selection : selections)
        add_once(forms_of(selection, merged), result);
    return result;
}

std::vector<Stack> stacks_of(const Document& document) {
    std::vector<Stack> stacks;
    const auto add = [&](const Layer* variant) {
        Stack& stack = stacks.emplace_back(Stack{variant, merge({&document.base, variant, &document.overrides}), {}});
        stack.forms = possible_forms(stack.merged);
    };
    for (const Layer& variant : document.variants)
        add(&variant);
    if (stacks.empty())
        add(nullptr);
    return stacks;
}

bool applies_to_any(const Key& key, const std::vector<Forms>& forms) {
    return std::ranges::any_of(forms, [&](const Forms& one) { return applies(key, one); });
}

bool grid_fits_mesh(const Merged& merged) {
    const int samples = merged.ranks[key_index("grid.samples")];
    for (std::size_t key = 0; key < merged.ranks.size(); ++key)
        if (schema_keys()[key].table == "grid" && merged.ranks[key] > samples)
            return false;
    return true;
}

void drop_inapplicable(Selection& selection, const Merged& merged) {
    const Forms forms = forms_of(selection, merged);
    const std::size_t samples = key_index("grid.samples");
    const bool fits = grid_fits_mesh(merged);
    const auto is_grid = [](std::size_t key) { return schema_keys()[key].table == "grid"; };
    for (std::size_t i = 0; i < selection.size(); ++i)
        if (!applies(schema_keys()[i], forms) ||
            (is_grid(i) && merged.tables.contains("paths") && !merged.tables.contains("grid")) ||
            (i == samples && !fits))
            selection[i] = nullptr;
    for (std::size_t i = 0; i < selection.size(); ++i)
        if (selection[samples] && is_grid(i) && i != samples)
            selection[i] = nullptr;
}

std::string identity(const Selection& selection) {
    std::string result;
    for (std::size_t i = 0; i < selection.size(); ++i)
        if (selection[i])
            result += schema_keys()[i].path() + '=' + identity(*selection[i]) + ';';
    return result;
}

Scene build_scene(const Selection& selection) {
    Scene scene;
    scene.field = false;
    for (std::size_t i = 0; i < selection.size(); ++i) {
        if (!selection[i])
            continue;
        const Key& key = schema_keys()[i];
        const bool vibration = key.table == "texture" && (key.forms & kFormVibration);
        if (vibration && !scene.vibration)
            scene.vibration.emplace();
        if (key.table == "texture" && !vibration && !scene.texture)
            scene.texture.emplace();
        if (key.table == "friction" && !scene.friction)
            scene.friction.emplace();
        if (key.table == "paths" && !scene.paths)
            scene.paths.emplace();
        if (key.table == "compare" && !scene.compare)
            scene.compare.emplace();
        scene.field = scene.field || key.table == "grid";
        key.set(scene, *selection[i]);
    }
    return scene;
}

void refuse_pattern(const std::string& pattern, std::size_t cases, const std::string& first) {
    throw UsageError("--only \"{}\" matches none of {} cases; the first is {}", pattern, cases, first);
}

std::vector<const Case*> cases_named(const Study& study, const std::string& pattern) {
    std::vector<const Case*> chosen;
    for (const Case& one : study.cases)
        if (fnmatch(pattern.c_str(), one.name.c_str(), 0) == 0)
            chosen.push_back(&one);
    if (chosen.empty())
        refuse_pattern(pattern, study.cases.size(), study.cases.front().name);
    return chosen;
}

} // namespace forceshade
