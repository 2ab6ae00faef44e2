#include "host/scene/cases.h"

#include <algorithm>
#include <map>
#include <set>

#include <fmt/format.h>
#include <fnmatch.h>

#include "host/error.h"

namespace forceshade {

namespace {

std::size_t key_index(std::string_view path) {
    return static_cast<std::size_t>(find_key(path));
}

struct Selectors {
    std::size_t kind = key_index("surface.kind");
    std::size_t function = key_index("surface.function");
    std::size_t file = key_index("surface.file");
    std::size_t shading = key_index("force.shading");
    std::size_t texture_function = key_index("texture.function");
    std::size_t texture_file = key_index("texture.file");
    std::size_t paths_kind = key_index("paths.kind");
    std::size_t loop = key_index("paths.loop");
    std::size_t press = key_index("paths.press");
    std::size_t push = key_index("paths.push");
};

const Selectors& selectors() {
    static const Selectors indices;
    return indices;
}

std::uint32_t map_form(const Value& function) {
    return std::uint32_t{kFormMapCylinder} << function.integers.front();
}

std::uint32_t surface_form(const Value& kind, std::uint32_t map) {
    switch (static_cast<SurfaceKind>(kind.integers.front())) {
    case SurfaceKind::bump:
        return kFormBump;
    case SurfaceKind::cylinder_bump:
        return kFormCylinderBump;
    case SurfaceKind::mesh:
        return kFormMesh;
    case SurfaceKind::height_map:
        break;
    }
    return map;
}

bool is_reference(const Value& shading) {
    return static_cast<Shading>(shading.integers.front()) == Shading::reference;
}

std::vector<std::uint32_t> map_forms(const Entry* function, const Entry* file) {
    if (file)
        return {kFormMapFile};
    std::vector<std::uint32_t> forms;
    for (const Value& value : function->values)
        forms.push_back(map_form(value));
    return forms;
}

// Without paths a hand is what a scene says of it, with them it is needed in closed loop.
Forms with_paths(Forms forms, std::uint32_t kind, bool closed_loop, bool hand) {
    forms.paths = kind;
    forms.closed_loop = kind != 0 && closed_loop;
    forms.hand = kind != 0 ? closed_loop : hand;
    return forms;
}

std::uint32_t path_form(const Value& kind) {
    return 1u << kind.integers.front();
}

bool is_closed(const Value& loop) {
    return static_cast<PathLoop>(loop.integers.front()) == PathLoop::closed;
}

// One form with every outcome that the paths allow.
std::vector<Forms> with_paths(const Merged& merged, const Forms& form) {
    const Selectors& s = selectors();
    if (!merged.paths)
        return {with_paths(form, 0, false, merged.hand)};
    std::vector<bool> loops;
    if (const Entry* loop = merged.entries[s.loop])
        for (const Value& value : loop->values)
            loops.push_back(is_closed(value));
    else
        loops.push_back(merged.entries[s.press] || merged.entries[s.push]);
    std::vector<Forms> result;
    for (const Value& kind : merged.entries[s.paths_kind]->values)
        for (const bool closed : loops)
            result.push_back(with_paths(form, path_form(kind), closed, merged.hand));
    return result;
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
        merged.texture = merged.texture || layer->texture;
        merged.paths = merged.paths || layer->paths;
        merged.hand = merged.hand || layer->hand;
        merged.grid = merged.grid || layer->grid;
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

std::vector<Forms> possible_forms(const Merged& merged) {
    const Selectors& s = selectors();
    const auto& entries = merged.entries;
    std::vector<std::uint32_t> textures{0};
    if (merged.texture)
        textures = map_forms(entries[s.texture_function], entries[s.texture_file]);
    std::vector<Forms> result;
    for (const Value& kind : entries[s.kind]->values)
        for (const std::uint32_t map : map_forms(entries[s.function], entries[s.file]))
            for (const std::uint32_t texture : textures)
                for (const Value& shading : entries[s.shading]->values) {
                    const Forms one{surface_form(kind, map), texture, is_reference(shading)};
                    for (const Forms& forms : with_paths(merged, one))
                        if (std::find(result.begin(), result.end(), forms) == result.end())
                            result.push_back(forms);
                }
    return result;
}

bool applies_to_any(const Key& key, const std::vector<Forms>& forms) {
    return std::any_of(forms.begin(), forms.end(), [&](const Forms& one) { return applies(key, one); });
}

bool grid_fits_mesh(const Merged& merged) {
    const int samples = merged.ranks[key_index("grid.samples")];
    for (std::size_t key = 0; key < merged.ranks.size(); ++key)
        if (schema_keys()[key].table == "grid" && merged.ranks[key] > samples)
            return false;
    return true;
}

void drop_inapplicable(Selection& selection, const Merged& merged) {
    const Selectors& s = selectors();
    const std::uint32_t map = selection[s.file] ? std::uint32_t{kFormMapFile} : map_form(*selection[s.function]);
    Forms forms{surface_form(*selection[s.kind], map), 0, is_reference(*selection[s.shading])};
    if (merged.texture)
        forms.texture =
            selection[s.texture_file] ? std::uint32_t{kFormMapFile} : map_form(*selection[s.texture_function]);
    const bool pressed = selection[s.press] || selection[s.push];
    const bool closed = selection[s.loop] ? is_closed(*selection[s.loop]) : pressed;
    forms = with_paths(forms, merged.paths ? path_form(*selection[s.paths_kind]) : 0, closed, merged.hand);
    for (std::size_t i = 0; i < selection.size(); ++i)
        if (!applies(schema_keys()[i], forms) || (schema_keys()[i].table == "grid" && merged.paths && !merged.grid))
            selection[i] = nullptr;
    const std::size_t samples = key_index("grid.samples");
    if (!selection[samples])
        return;
    if (!grid_fits_mesh(merged)) {
        selection[samples] = nullptr;
        return;
    }
    for (std::size_t i = 0; i < selection.size(); ++i)
        if (schema_keys()[i].table == "grid" && i != samples)
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
    static constexpr std::string_view kMicro[] = {"\u00b5", "\u03bc"};
    std::string result;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const bool micro = text.substr(i).starts_with(kMicro[0]) || text.substr(i).starts_with(kMicro[1]);
        if (micro) {
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

std::string lower_case(std::string text) {
    for (char& c : text)
        if (c >= 'A' && c <= 'Z')
            c = static_cast<char>(c - 'A' + 'a');
    return text;
}

// The value that stands for a key in comparisons: function and file are one choice, and a texture may be absent.
std::string compared(const Selection& selection, std::size_t key) {
    for (std::size_t other = 0; other < selection.size(); ++other)
        if (replaces(key, other) && !selection[key] && selection[other])
            return "other";
    if (selection[key])
        return identity(*selection[key]);
    const Key& info = schema_keys()[key];
    return info.table == "texture" && (info.name == "function" || info.name == "file") ? "absent" : "";
}

// Keys whose value is not the same in all cases that have it, in file order, without the kind.
std::vector<std::size_t> varying_keys(const std::vector<Selection>& selections, const std::vector<std::size_t>& order) {
    std::vector<std::size_t> keys;
    for (const std::size_t key : order) {
        std::set<std::string> values;
        const auto has_key = [key](const Selection& selection) { return selection[key] != nullptr; };
        if (std::none_of(selections.begin(), selections.end(), has_key))
            continue;
        for (const Selection& selection : selections)
            if (const std::string text = compared(selection, key); !text.empty())
                values.insert(text);
        if (values.size() > 1 && schema_keys()[key].path() != "surface.kind")
            keys.push_back(key);
    }
    return keys;
}

// A key's last part; with its table where that would leave open which key is meant. A texture's keys always have
// theirs, those of paths if another table has a key of that name.
std::string label(std::size_t key, const std::vector<std::size_t>& varying) {
    const Key& info = schema_keys()[key];
    const auto same_name = [&](std::size_t other) {
        return other != key && schema_keys()[other].name == info.name && schema_keys()[other].table != "texture";
    };
    const auto shared = [&](const Key& other) { return other.name == info.name && other.table != info.table; };
    const auto keys = schema_keys();
    const bool ambiguous = std::any_of(varying.begin(), varying.end(), same_name) ||
                           (info.table == "paths" && std::any_of(keys.begin(), keys.end(), shared));
    return ambiguous || info.table == "texture" ? info.path() : std::string(info.name);
}

std::string file_name_text(const Key& key, const Value& value) {
    if (key.kind == ValueKind::file)
        return std::filesystem::path(value.path).filename().string();
    return plain_text(value, key.kind == ValueKind::choices ? '+' : 'x');
}

void fill_in(Case& one, const Selection& selection, const std::vector<std::size_t>& varying) {
    const auto kind = static_cast<std::size_t>(find_key("surface.kind"));
    const auto shading = static_cast<std::size_t>(find_key("force.shading"));
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
