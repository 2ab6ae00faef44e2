#include "host/scene/selection.h"

#include <algorithm>

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

} // namespace forceshade
