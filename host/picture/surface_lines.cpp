#include "host/picture/surface_lines.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "host/output/height_image.h"
#include "host/prepare/prepared_case.h"
#include "host/prepare/tables.h"
#include "host/reference/elementary.h"

namespace forceshade {

namespace {

constexpr std::size_t kPoints = 401;          // of a curve; more would not show
constexpr std::uint32_t kMostVertices = 2000; // beyond that facets do not show either, and the circle is drawn

double circle_height(double half_width, double radius, double x) {
    if (std::abs(x) >= half_width)
        return 0;
    return reference::cylinder_height(half_width, radius, std::sqrt((radius - half_width) * (radius + half_width)), x);
}

double image_height(const HeightMapSpec& map, const HeightImage& image, double x, double y) {
    if (2 * std::abs(x) > map.size[0] || 2 * std::abs(y) > map.size[1])
        return 0;
    const auto cell = [](double position, std::size_t count) {
        const double clamped = std::clamp(position, 0.0, static_cast<double>(count - 1));
        const auto low = std::min(static_cast<std::size_t>(clamped), count > 1 ? count - 2 : 0);
        return std::pair(low, clamped - static_cast<double>(low));
    };
    const auto [column, across] = cell((x / map.size[0] + 0.5) * static_cast<double>(image.columns - 1), image.columns);
    const auto [row, down] = cell((0.5 - y / map.size[1]) * static_cast<double>(image.rows - 1), image.rows);
    const auto at = [&](std::size_t i, std::size_t j) {
        return image.samples[std::min(j, image.rows - 1) * image.columns + std::min(i, image.columns - 1)];
    };
    const double top = std::lerp(at(column, row), at(column + 1, row), across);
    const double bottom = std::lerp(at(column, row + 1), at(column + 1, row + 1), across);
    return map.height * std::lerp(top, bottom, down);
}

double map_height(const HeightMapSpec& map, const HeightImage* image, double x, double y) {
    switch (map.function) {
    case MapFunction::cylinder:
        return circle_height(map.width / 2, map.radius, x);
    case MapFunction::dip:
        return -circle_height(map.width / 2, map.radius, x);
    case MapFunction::sine:
        return map.height * std::sin(2 * std::numbers::pi * std::fmod(x / map.width, 1.0));
    case MapFunction::gaussian:
        return map.height * std::exp(-(x * x + y * y) / (map.radius * map.radius));
    case MapFunction::file:
        return image_height(map, *image, x, y);
    }
    return 0;
}

struct Span {
    double from, to; /* m */
};

template <typename Height> std::vector<picture::LinePoint> curve(Span x, const Height& height) {
    std::vector<picture::LinePoint> points(kPoints);
    for (std::size_t i = 0; i < kPoints; ++i) {
        const double at = std::lerp(x.from, x.to, static_cast<double>(i) / (kPoints - 1));
        points[i] = {at, height(at)};
    }
    return points;
}

std::vector<picture::LinePoint> facet_line(const SurfaceSpec& surface, Span x) {
    const double half_width = surface.width / 2;
    std::vector<picture::LinePoint> points;
    if (x.from < -half_width)
        points.push_back({x.from, 0});
    for (const double vertex :
         facet_vertices<double>(surface.facets, half_width, surface.radius, surface.facet_spacing))
        points.push_back({vertex, circle_height(half_width, surface.radius, vertex)});
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

picture::SurfaceLines surface_lines(const PreparedCase& prepared, const SectionSpan& section) {
    const Scene& scene = prepared.one.scene;
    const Span x{section.from, section.to};
    const SurfaceSpec& surface = scene.surface;
    const auto circle = [&](double at) { return circle_height(surface.width / 2, surface.radius, at); };
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
                curve(x, [&](double at) { return map_height(surface.map, prepared.images.map.get(), at, section.y); });
        break;
    case SurfaceKind::mesh:
        lines.nominal = mesh_section(prepared.images.mesh->mesh, section.y);
        break;
    }
    return lines;
}

picture::SurfaceLines surface_lines(const PreparedCase& prepared, double y) {
    const GridSpec& grid = prepared.one.scene.grid;
    if (grid.size[0] < 2)
        return {};
    return surface_lines(prepared,
                         {grid.origin[0], grid.origin[0] + grid.spacing[0] * static_cast<double>(grid.size[0] - 1), y});
}

} // namespace forceshade
