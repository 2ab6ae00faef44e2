// What a scene says of its pictures.
#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numbers>

#include <fmt/format.h>

#include "host/field/case_law.h"
#include "host/field/prepared_case.h"
#include "host/output/height_image.h"
#include "host/picture/frame.h"
#include "host/picture/picture.h"
#include "host/reference/surfaces.h"
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
        return fmt::format("Bump of {}, radius {}", counted(surface.facets, "facet"),
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

namespace forceshade {

namespace {

constexpr std::size_t kPoints = 401;          // of a curve; more would not show
constexpr std::uint32_t kMostVertices = 2000; // beyond that facets do not show either, and the circle is drawn

double image_height(const HeightMapSpec& map, const HeightImage& image, double x, double y) {
    if (2 * std::abs(x) > map.size[0] || 2 * std::abs(y) > map.size[1])
        return 0;
    const auto cell = [](double share, std::size_t count) {
        return reference::cell_at(std::clamp(share, 0.0, 1.0) * static_cast<double>(count - 1),
                                  static_cast<layout::uint>(count));
    };
    const reference::Cell<double> across = cell(x / map.size[0] + 0.5, image.columns),
                                  down = cell(0.5 - y / map.size[1], image.rows);
    const auto in_row = [&](std::size_t row) {
        return std::lerp(image.samples[row * image.columns + across.low],
                         image.samples[row * image.columns + across.high], across.fraction);
    };
    return map.height * std::lerp(in_row(down.low), in_row(down.high), down.fraction);
}

double map_height(const HeightMapSpec& map, const HeightImage* image, double x, double y) {
    switch (map.function) {
    case MapFunction::cylinder:
        return reference::cylinder_height(map.width / 2, map.radius, x);
    case MapFunction::dip:
        return -reference::cylinder_height(map.width / 2, map.radius, x);
    case MapFunction::sine:
        return map.height * std::sin(2 * std::numbers::pi * std::fmod(x / map.width, 1.0));
    case MapFunction::gaussian:
        return map.height * std::exp(-(x * x + y * y) / (map.radius * map.radius));
    case MapFunction::file:
        return image_height(map, *image, x, y);
    }
    return 0;
}

template <typename Height> std::vector<picture::LinePoint> curve(const SectionSpan& x, const Height& height) {
    std::vector<picture::LinePoint> points(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
        const double at = std::lerp(x.from, x.to, static_cast<double>(i) / (kPoints - 1));
        points[i] = {at, height(at)};
    }
    return points;
}

std::vector<picture::LinePoint> facet_line(const SurfaceSpec& surface, const SectionSpan& x) {
    const double half_width = surface.width / 2;
    std::vector<picture::LinePoint> points;
    if (x.from < -half_width)
        points.push_back({x.from, 0});
    for (const double vertex :
         facet_vertices<double>(surface.facets, half_width, surface.radius, surface.facet_spacing))
        points.push_back({vertex, reference::cylinder_height(half_width, surface.radius, vertex)});
    if (x.to > half_width)
        points.push_back({x.to, 0});
    return points;
}

// Where the plane of this y cuts the triangles: pieces of two points, parted by points that are none.
std::vector<picture::LinePoint> mesh_section(const Mesh& mesh, double y) {
    constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
    std::vector<picture::LinePoint> points;
    for (const auto& triangle : mesh.triangles.corners) {
        std::vector<picture::LinePoint> cuts;
        for (std::size_t i = 0; i < 3; ++i) {
            const glm::dvec3 &from = mesh.polygons.vertices[triangle[i]],
                             &to = mesh.polygons.vertices[triangle[(i + 1) % 3]];
            if ((from.y < y) == (to.y < y))
                continue;
            const double part = (y - from.y) / (to.y - from.y);
            cuts.push_back({std::lerp(from.x, to.x, part), std::lerp(from.z, to.z, part)});
        }
        if (cuts.size() == 2)
            points.insert(points.end(), {cuts[0], cuts[1], {kNone, kNone}});
    }
    return points;
}

} // namespace

picture::SurfaceLines surface_lines(const PreparedCase& prepared, const SectionSpan& x) {
    const Scene& scene = prepared.one.scene;
    const SurfaceSpec& surface = scene.surface;
    const auto circle = [&](double at) { return reference::cylinder_height(surface.width / 2, surface.radius, at); };
    picture::SurfaceLines lines;
    switch (surface.kind) {
    case SurfaceKind::bump:
        lines.nominal = surface.facets <= kMostVertices ? facet_line(surface, x) : curve(x, circle);
        if (scene.force.shading != Shading::none)
            lines.smooth = curve(x, circle);
        break;
    case SurfaceKind::cylinder_bump:
        lines.nominal = curve(x, circle);
        break;
    case SurfaceKind::height_map:
        lines.nominal = {{x.from, 0}, {x.to, 0}};
        if (scene.force.shading != Shading::none)
            lines.smooth =
                curve(x, [&](double at) { return map_height(surface.map, prepared.images.map.get(), at, x.y); });
        break;
    case SurfaceKind::mesh:
        lines.nominal = mesh_section(prepared.images.mesh->mesh, x.y);
        break;
    }
    return lines;
}

picture::SurfaceLines surface_lines(const PreparedCase& prepared, double y) {
    const GridSpec& grid = prepared.one.scene.grid;
    if (grid.size[0] < 2)
        return {};
    return surface_lines(prepared, {grid.origin[0], grid.last(0), y});
}

namespace {

// m: the highest point of a section's pieces at x; NaN where there is none.
double height_at(const std::vector<picture::LinePoint>& line, double x) {
    double height = NAN;
    for (std::size_t i = 1; i < line.size(); ++i) {
        const auto& [low, high] = std::minmax(line[i - 1], line[i], [](auto& a, auto& b) { return a.x < b.x; });
        if (x >= low.x && x <= high.x)
            height = std::fmax(height, high.x > low.x ? std::lerp(low.z, high.z, (x - low.x) / (high.x - low.x))
                                                      : std::fmax(low.z, high.z));
    }
    return height;
}

} // namespace

double pressed_depth(const PreparedCase& prepared) {
    constexpr double kPressed = 1e-3; // m
    constexpr double kFlat = 1e-6;    // of the longest side: a sheet, which is pressed like a plane
    const SurfaceSpec& surface = prepared.one.scene.surface;
    double across = INFINITY; /* m */
    if (surface.kind == SurfaceKind::bump || surface.kind == SurfaceKind::cylinder_bump)
        across = surface.width;
    if (prepared.images.mesh) {
        const MeshBox box = bounding_box(prepared.images.mesh->mesh.polygons);
        const glm::dvec3 sides = box.high - box.low;
        for (const double side : {sides.x, sides.y, sides.z})
            if (side > kFlat * std::max({sides.x, sides.y, sides.z}))
                across = std::min(across, side);
    }
    return std::min(kPressed, across / 20);
}

SceneStroke stroke_of(const PreparedCase& prepared, double y) {
    constexpr std::size_t kSamples = 1001;
    const GridSpec& grid = prepared.one.scene.grid;
    SceneStroke stroke{{}, pressed_depth(prepared)};
    const double from = grid.origin[0] - grid.spacing[0] / 2;
    const double length = grid.spacing[0] * static_cast<double>(grid.size[0]);
    const std::vector<picture::LinePoint> line = surface_lines(prepared, {from, from + length, y}).nominal;
    const CaseLaw<double> law(prepared);
    layout::uint hint = 0;
    for (std::size_t i = 0; i < kSamples; ++i) {
        const double x = from + length * (static_cast<double>(i) + 0.5) / kSamples;
        const glm::dvec3 probe{x, y, height_at(line, x) - stroke.depth};
        picture::StrokedForce& one =
            stroke.forces.emplace_back(picture::StrokedForce{x, {NAN, NAN, NAN}, {NAN, NAN, NAN}});
        if (!std::isfinite(probe.z) || !law.reaches(probe))
            continue;
        const reference::Contact<double> found = law.at(probe, hint);
        one.force = {found.force.x, found.force.y, found.force.z};
        one.unshaded = {found.unshaded.x, found.unshaded.y, found.unshaded.z};
    }
    return stroke;
}

} // namespace forceshade
