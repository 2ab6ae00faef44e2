#include "host/scene/schema.h"

#include "host/scene/scene.h"
#include "host/scene/schema_keys.h"

#include <bit>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

namespace forceshade {

namespace {

std::string join_or(const std::vector<std::string_view>& names) {
    if (names.size() < 2)
        return fmt::format("{}", fmt::join(names, ""));
    return fmt::format("{} or {}", fmt::join(names.begin(), names.end() - 1, ", "), names.back());
}

// The names of the height maps among some forms, "file" included.
std::vector<std::string_view> map_names(std::uint32_t forms) {
    std::vector<std::string_view> names;
    for (std::size_t i = 0; i < kMapFunctions.size(); ++i)
        if (forms & (kFormMapCylinder << i))
            names.push_back(kMapFunctions[i]);
    if (forms & kFormMapFile)
        names.push_back("file");
    return names;
}

std::string describe_path_forms(const Key& key, const Forms& forms) {
    if (forms.paths == 0)
        return "a scene without [paths]";
    if (key.subject == Subject::paths && (key.forms & forms.paths) == 0)
        return fmt::format("kind \"{}\"", kPathKinds[static_cast<std::size_t>(std::countr_zero(forms.paths))]);
    return "an open loop";
}

std::string describe_path_applicability(const Key& key) {
    std::vector<std::string_view> kinds;
    for (std::size_t i = 0; i < kPathKinds.size(); ++i)
        if (key.forms & (1u << i))
            kinds.push_back(kPathKinds[i]);
    const std::string_view loop = key.closed_loop ? "a closed loop" : "";
    if (kinds.size() == kPathKinds.size())
        return std::string(loop);
    const auto recorded = static_cast<std::uint32_t>(PathKind::recorded);
    const std::string kind = kinds.size() + 1 == kPathKinds.size() && !(key.forms & (1u << recorded))
                                 ? "every kind but recorded"
                                 : fmt::format("kind {}", join_or(kinds));
    return loop.empty() ? kind : fmt::format("{} in {}", kind, loop);
}

} // namespace

std::string Key::path() const {
    return fmt::format("{}.{}", table, name);
}

std::span<const Key> schema_keys() {
    static const std::vector<Key> keys = make_keys();
    return keys;
}

int find_key(std::string_view path) {
    const auto keys = schema_keys();
    const std::size_t dot = path.find('.');
    if (dot == std::string_view::npos)
        return -1;
    for (std::size_t i = 0; i < keys.size(); ++i)
        if (keys[i].table == path.substr(0, dot) && keys[i].name == path.substr(dot + 1))
            return static_cast<int>(i);
    return -1;
}

bool applies(const Key& key, const Forms& forms) {
    switch (key.subject) {
    case Subject::none:
        return true;
    case Subject::surface:
        return (key.forms & forms.surface) != 0;
    case Subject::texture:
        return (key.forms & forms.texture) != 0;
    case Subject::shading:
        return (key.forms & forms.surface) != 0 && forms.reference_shading;
    case Subject::paths:
        return (key.forms & forms.paths) != 0 && (!key.closed_loop || forms.closed_loop);
    case Subject::hand:
        return forms.hand;
    }
    return true;
}

std::string describe_forms(const Key& key, const Forms& forms) {
    if (key.subject == Subject::paths || key.subject == Subject::hand)
        return describe_path_forms(key, forms);
    const std::uint32_t form = key.subject == Subject::texture ? forms.texture : forms.surface;
    if (form == 0)
        return "a scene without [texture]";
    if (form == kFormMesh)
        return fmt::format("kind \"{}\"", kSurfaceKinds[3]);
    if (form & kFormBumps) {
        const auto kind = kSurfaceKinds[form == kFormBump ? 0 : 1];
        const bool shading = key.subject == Subject::shading && (key.forms & form);
        return fmt::format("kind \"{}\"{}", kind, shading ? " without shading \"reference\"" : "");
    }
    const std::string map = form == kFormMapFile ? "a file" : fmt::format("function \"{}\"", map_names(form).front());
    return key.subject == Subject::texture ? map : fmt::format("kind \"height_map\" with {}", map);
}

std::string describe_applicability(const Key& key) {
    if (key.subject == Subject::none)
        return "";
    if (key.subject == Subject::hand)
        return "a closed loop";
    if (key.subject == Subject::paths)
        return describe_path_applicability(key);
    std::vector<std::string_view> kinds;
    if (key.forms & kFormBump)
        kinds.push_back(kSurfaceKinds[0]);
    if (key.forms & kFormCylinderBump)
        kinds.push_back(kSurfaceKinds[1]);
    if (key.forms & kFormMesh)
        kinds.push_back(kSurfaceKinds[3]);
    const std::string maps = join_or(map_names(key.forms));
    if (key.subject == Subject::texture)
        return maps;
    if (key.subject == Subject::shading)
        return "kind bump with shading reference";
    const std::string plain = kinds.empty() ? "" : fmt::format("kind {}", join_or(kinds));
    const std::string map = maps.empty() ? "" : fmt::format("kind height_map with {}", maps);
    return plain.empty() || map.empty() ? plain + map : fmt::format("{}; {}", plain, map);
}

} // namespace forceshade
