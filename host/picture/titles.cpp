#include "host/picture/titles.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "host/picture/quantity.h"
#include "host/scene/schema.h"

namespace forceshade::picture {
namespace {

std::string map_words(const HeightMapSpec& map) {
    if (map.function == MapFunction::file)
        return "an image";
    if (map.function == MapFunction::sine)
        return "a sine, wavelength " + quantity_text(map.width, "m");
    static constexpr std::array kShapes{"cylinder", "dip", "sine", "Gaussian bump"};
    return fmt::format("a {}, radius {}", kShapes[static_cast<std::size_t>(map.function)],
                       quantity_text(map.radius, "m"));
}

std::string surface_words(const SurfaceSpec& surface) {
    switch (surface.kind) {
    case SurfaceKind::bump:
        return fmt::format("Bump of {} facet{}, radius {}", surface.facets, surface.facets == 1 ? "" : "s",
                           quantity_text(surface.radius, "m"));
    case SurfaceKind::cylinder_bump:
        return "Cylinder bump, radius " + quantity_text(surface.radius, "m");
    case SurfaceKind::height_map:
        return "Plane with the height map of " + map_words(surface.map);
    case SurfaceKind::mesh:
        return "Mesh " + std::filesystem::path(surface.mesh.file).stem().string();
    }
    return "";
}

// In the order of Shading.
constexpr std::array kShadingWords{"unshaded",
                                   "shaded as its cylinder",
                                   "shaded as the height map",
                                   "shaded after Morgenbesser",
                                   "shaded by barycentric normals",
                                   "shaded by mean-value normals",
                                   "shaded in two passes"};

std::string with_spaces(std::string name) {
    std::ranges::replace_if(
        name, [](char c) { return c == '_' || c == '.'; }, ' ');
    return name;
}

} // namespace

std::string title_of(const Case& one, bool with_shading) {
    static constexpr std::array<std::string_view, 6> kSaid{"kind", "radius", "facets", "shading", "function", "file"};
    std::string title = surface_words(one.scene.surface);
    if (with_shading)
        title += fmt::format(", {}", kShadingWords[static_cast<std::size_t>(one.scene.force.shading)]);
    if (one.scene.texture)
        title += ", with a texture of " + map_words(one.scene.texture->map);
    for (const auto& [key, value] : one.varied)
        if (std::ranges::find(kSaid, key) == kSaid.end() && key != "texture.function")
            title += fmt::format(", {} {}", with_spaces(key), with_spaces(value));
    return title;
}

std::string paths_title(const PathsSpec& paths) {
    if (paths.kind == PathKind::recorded)
        return "recorded paths";
    std::string kind = with_spaces(std::string(kPathKinds[static_cast<std::size_t>(paths.kind)]));
    return fmt::format("{} paths ({})", paths.count, kind);
}

} // namespace forceshade::picture
