#include "host/scene/cases.h"

#include <algorithm>
#include <array>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"

namespace forceshade {

namespace {

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

// Of a choice of one value for each key.
Forms forms_of(const Selection& selection, const Merged& merged) {
    constexpr std::array<std::uint32_t, 4> kSurfaceForms{kFormBump, kFormCylinderBump, 0, kFormMesh};
    const auto kind = static_cast<SurfaceKind>(chosen(selection, "surface.kind"));
    Forms forms;
    forms.surface = kind == SurfaceKind::height_map ? map_form(selection, "surface")
                                                    : kSurfaceForms[static_cast<std::size_t>(kind)];
    forms.texture = merged.has("texture") ? map_form(selection, "texture") : 0;
    forms.reference_shading = static_cast<Shading>(chosen(selection, "force.shading")) == Shading::reference;
    forms.hand = merged.has("hand");
    forms.compare = merged.has("compare") ? 1u << chosen(selection, "compare.surface.kind") : 0;
    if (!merged.has("paths"))
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

std::vector<Forms> possible_forms(const Merged& merged) {
    std::vector<Selection> selections{first_values(merged)};
    for (const char* path : {"surface.kind", "surface.function", "force.shading", "texture.function", "paths.kind",
                             "paths.loop", "compare.surface.kind"}) {
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
        if (!applies(schema_keys()[i], forms) || (is_grid(i) && merged.has("paths") && !merged.has("grid")) ||
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
        if (key.table == "texture" && !scene.texture)
            scene.texture.emplace();
        if (key.table == "paths" && !scene.paths)
            scene.paths.emplace();
        if (key.table == "compare" && !scene.compare)
            scene.compare.emplace();
        scene.field = scene.field || key.table == "grid";
        key.set(scene, *selection[i]);
    }
    return scene;
}

namespace {

constexpr std::size_t kLongestName = 150; // bytes: room for an extension and a temporary's prefix under the usual 255
constexpr std::size_t kHashDigits = 12;

bool is_safe(char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '_' ||
           c == '+' || c == '-';
}

// "0.5 N/mm" -> "0.5N-mm", "1 µm" -> "1um".
std::string safe_text(std::string_view text) {
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        if (text.substr(i).starts_with("\u00b5") || text.substr(i).starts_with("\u03bc")) {
            result += 'u';
            ++i;
        } else if (text[i] == '/') {
            result += '-';
        } else if (text[i] != ' ' && text[i] != '\t') {
            result += is_safe(text[i]) ? text[i] : '_';
        }
    }
    return result;
}

// FNV-1a: the same on every machine and in every run.
std::string hash_text(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325u;
    for (const char c : text)
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3u;
    return fmt::format("{:016x}", hash).substr(16 - kHashDigits);
}

// What is compared of a key: function and file are one choice, and a texture or comparison may be absent.
std::string compared(const Selection& selection, std::size_t key) {
    for (std::size_t other = 0; other < selection.size(); ++other)
        if (replaces(key, other) && !selection[key] && selection[other])
            return "other";
    if (selection[key])
        return identity(*selection[key]);
    const Key& info = schema_keys()[key];
    const bool texture = info.table == "texture" && (info.name == "function" || info.name == "file");
    return texture || info.path() == "compare.surface.kind" ? "absent" : "";
}

// Keys whose value is not the same in all cases that have it, in file order, without the kind.
std::vector<std::size_t> varying_keys(const std::vector<Selection>& selections, const std::vector<std::size_t>& order) {
    std::vector<std::size_t> keys;
    for (const std::size_t key : order) {
        std::set<std::string> values;
        const auto has_key = [key](const Selection& selection) { return selection[key] != nullptr; };
        if (std::ranges::none_of(selections, has_key))
            continue;
        for (const Selection& selection : selections)
            if (const std::string text = compared(selection, key); !text.empty())
                values.insert(text);
        if (values.size() > 1 && schema_keys()[key].path() != "surface.kind")
            keys.push_back(key);
    }
    return keys;
}

// A key's last part; with its table where that would leave open which key is meant. A texture's and a comparison's keys
// always have theirs, those of paths if another table has a key of that name.
std::string label(std::size_t key, const std::vector<std::size_t>& varying) {
    const Key& info = schema_keys()[key];
    const auto same_name = [&](std::size_t other) {
        return other != key && schema_keys()[other].name == info.name && schema_keys()[other].table != "texture";
    };
    const auto shared = [&](const Key& other) { return other.name == info.name && other.table != info.table; };
    const bool ambiguous = std::ranges::any_of(varying, same_name) ||
                           (info.table == "paths" && std::ranges::any_of(schema_keys(), shared));
    return ambiguous || info.table == "texture" || info.table == "compare" ? info.path() : std::string(info.name);
}

std::string file_name_text(const Key& key, const Value& value) {
    if (key.kind == ValueKind::file)
        return std::filesystem::path(value.path).filename().string();
    return plain_text(value, key.kind == ValueKind::choices ? '+' : 'x');
}

void fill_in(Case& one, const Selection& selection, const std::vector<std::size_t>& varying) {
    const auto kind = key_index("surface.kind");
    const auto shading = key_index("force.shading");
    one.varied.emplace_back("kind", selection[kind]->texts.front());
    one.name = one.varied.front().second;
    for (const std::size_t key : varying) {
        // A cylinder has no shading to choose.
        if (!selection[key] || (key == shading && one.scene.surface.kind == SurfaceKind::cylinder_bump))
            continue;
        const std::string text = file_name_text(schema_keys()[key], *selection[key]);
        one.varied.emplace_back(label(key, varying), text);
        one.name += fmt::format("_{}-{}", one.varied.back().first, safe_text(text));
    }
    if (one.name.back() == '.') // Windows drops it
        one.name.back() = '_';
}

} // namespace

void name_cases(std::vector<Case>& cases, const std::vector<Selection>& selections,
                const std::vector<std::size_t>& order) {
    const std::vector<std::size_t> varying = varying_keys(selections, order);
    std::map<std::string, int> uses;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        fill_in(cases[i], selections[i], varying);
        ++uses[lower_case(cases[i].name)];
    }
    std::set<std::string> names;
    for (std::size_t i = 0; i < cases.size(); ++i) {
        std::string& name = cases[i].name;
        if (name.size() > kLongestName || uses[lower_case(name)] > 1)
            name = fmt::format("{}_{}", name.substr(0, kLongestName - kHashDigits - 1),
                               hash_text(identity(selections[i])));
        if (!names.insert(lower_case(name)).second)
            throw UsageError(fmt::format("two cases of the study have the name {}", name));
    }
}

std::vector<const Case*> cases_named(const Study& study, const std::string& pattern) {
    std::vector<const Case*> chosen;
    for (const Case& one : study.cases)
        if (fnmatch(pattern.c_str(), one.name.c_str(), 0) == 0)
            chosen.push_back(&one);
    if (chosen.empty())
        throw UsageError(fmt::format("--only \"{}\" chooses none of {} cases; the first is {}", pattern,
                                     study.cases.size(), study.cases.empty() ? "" : study.cases.front().name));
    return chosen;
}

} // namespace forceshade
