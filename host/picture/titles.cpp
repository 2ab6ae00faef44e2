#include "host/picture/titles.h"

#include <algorithm>
#include <array>
#include <filesystem>

#include <fmt/format.h>

#include "host/picture/quantity.h"
#include "host/scene/schema.h"

namespace forceshade::picture {
namespace {

std::string millimetres(double metres) {
    return three_digits(metres * 1000) + " mm";
}

std::string map_words(const HeightMapSpec& map) {
    switch (map.function) {
    case MapFunction::cylinder:
        return "a cylinder, radius " + millimetres(map.radius);
    case MapFunction::dip:
        return "a dip, radius " + millimetres(map.radius);
    case MapFunction::sine:
        return "a sine, wavelength " + millimetres(map.width);
    case MapFunction::gaussian:
        return "a Gaussian bump, radius " + millimetres(map.radius);
    case MapFunction::file:
        return "an image";
    }
    return "";
}

std::string surface_words(const SurfaceSpec& surface) {
    switch (surface.kind) {
    case SurfaceKind::bump:
        return fmt::format("Bump of {} facet{}, radius {}", surface.facets, surface.facets == 1 ? "" : "s",
                           millimetres(surface.radius));
    case SurfaceKind::cylinder_bump:
        return "Cylinder bump, radius " + millimetres(surface.radius);
    case SurfaceKind::height_map:
        return "Plane with the height map of " + map_words(surface.map);
    case SurfaceKind::mesh:
        return "Mesh " + std::filesystem::path(surface.mesh.file).stem().string();
    }
    return "";
}

const char* shading_words(Shading shading) {
    switch (shading) {
    case Shading::none:
        return "unshaded";
    case Shading::reference:
        return "shaded as its cylinder";
    case Shading::height_map:
        return "shaded as the height map";
    case Shading::morgenbesser:
        return "shaded after Morgenbesser";
    case Shading::barycentric:
        return "shaded by barycentric normals";
    case Shading::mean_value:
        return "shaded by mean-value normals";
    case Shading::two_pass:
        return "shaded in two passes";
    }
    return "";
}

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
        title += fmt::format(", {}", shading_words(one.scene.force.shading));
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
