#include "host/touch/places.h"

#include <algorithm>
#include <array>
#include <cmath>

#include <glm/vector_relational.hpp>

#include "host/error.h"
#include "host/mesh/mesh.h"
#include "host/paths/motions.h"
#include "host/reference/elementary.h"
#include "host/touch/own_surfaces.h"

namespace forceshade {

namespace {

constexpr std::size_t kTriesAPlace = 32; // draws for each place that is kept
constexpr int kHalvings = 60;

// The true shape's surface point between a place inside and one outside, with its normal; `up` without one.
std::optional<TouchPlace> surface_between(const TouchedShape& shape, glm::dvec3 inside, glm::dvec3 outside,
                                          glm::dvec3 up) {
    if (!touches(shape.force({inside})) || touches(shape.force({outside})))
        return std::nullopt;
    for (int i = 0; i < kHalvings; ++i) {
        const glm::dvec3 middle = 0.5 * (inside + outside);
        if (middle == inside || middle == outside)
            break;
        (touches(shape.force({middle})) ? inside : outside) = middle;
    }
    const glm::dvec3 force = shape.force({inside - 1e-3 * shape.scale.shallowest() * up});
    return TouchPlace{inside, touches(force) ? force / reference::length(force) : up, 0};
}

std::optional<TouchPlace> on_graph(const TouchedShape& shape, double x, double y) {
    return surface_between(shape, {x, y, shape.low.z}, {x, y, shape.high.z}, {0, 0, 1});
}

std::array<glm::dvec3, 3> corners_of(const Mesh& mesh, std::size_t triangle) {
    const auto& at = mesh.triangles.corners[triangle];
    return {mesh.polygons.vertices[at[0]], mesh.polygons.vertices[at[1]], mesh.polygons.vertices[at[2]]};
}

std::optional<TouchPlace> on_triangle(const TouchedShape& shape, const Mesh& mesh, std::size_t i, double u, double v) {
    const auto [a, b, c] = corners_of(mesh, i);
    const glm::dvec3 at = a + u * (b - a) + v * (c - a), normal = mesh.triangles.normals[i],
                     reach = shape.scale.deepest * normal;
    return shape.smooth ? surface_between(shape, at - reach, at + reach, normal) : TouchPlace{at, normal, 0};
}

bool is_in_box(const TouchedShape& shape, const glm::dvec3& at) {
    return glm::all(glm::greaterThanEqual(at, shape.low)) && glm::all(glm::lessThanEqual(at, shape.high));
}

} // namespace

PlaceDraw::PlaceDraw(const TouchedShape& shape, const PreparedCase& prepared, std::uint64_t seed)
    : shape_(shape), mesh_(prepared.images.mesh ? &prepared.images.mesh->mesh : nullptr), draw_(seed) {
    if (!mesh_)
        return;
    double longest = 0; /* m: the unit of areas, which could leave the range of numbers */
    for (std::size_t i = 0; i < mesh_->triangles.corners.size(); ++i) {
        const auto [a, b, c] = corners_of(*mesh_, i);
        longest = std::max({longest, reference::largest_coordinate(b - a), reference::largest_coordinate(c - a)});
    }
    for (std::size_t i = 0; longest > 0 && i < mesh_->triangles.corners.size(); ++i) {
        const auto [a, b, c] = corners_of(*mesh_, i);
        const double area = reference::length(reference::cross((b - a) / longest, (c - a) / longest));
        areas_.push_back((areas_.empty() ? 0 : areas_.back()) + area);
    }
}

std::optional<TouchPlace> PlaceDraw::operator()() {
    std::optional<TouchPlace> place = mesh_ ? drawn_on_mesh() : drawn_on_graph();
    const TouchScale& scale = shape_.scale;
    const double depth = scale.shallowest() * std::pow(scale.deepest / scale.shallowest(), draw_(0, 1));
    if (!place)
        return place;
    place->depth = depth;
    place->at -= depth * place->normal;
    return is_in_box(shape_, place->at) && touches(shape_.force(*place)) ? place : std::nullopt;
}

std::optional<TouchPlace> PlaceDraw::drawn_on_graph() {
    const double x = draw_(shape_.low.x, shape_.high.x), y = draw_(shape_.low.y, shape_.high.y);
    return on_graph(shape_, x, y);
}

std::optional<TouchPlace> PlaceDraw::drawn_on_mesh() {
    if (areas_.empty() || !(areas_.back() > 0))
        return std::nullopt;
    const double share = draw_(0, areas_.back());
    const auto i = static_cast<std::size_t>(std::ranges::upper_bound(areas_, share) - areas_.begin());
    if (i == areas_.size())
        return std::nullopt;
    const double u = draw_(0, 1), v = draw_(0, 1);
    return u + v > 1 ? on_triangle(shape_, *mesh_, i, 1 - u, 1 - v) : on_triangle(shape_, *mesh_, i, u, v);
}

std::vector<TouchPlace> touched_places(const TouchedShape& shape, const PreparedCase& prepared, std::size_t count,
                                       std::uint64_t seed) {
    PlaceDraw draw(shape, prepared, seed);
    return touched_places(draw, count);
}

std::vector<TouchPlace> touched_places(PlaceDraw& draw, std::size_t count) {
    std::vector<TouchPlace> places;
    for (std::size_t tries = 0; places.size() < count && tries < kTriesAPlace * count; ++tries)
        if (const auto place = draw())
            places.push_back(*place);
    if (places.empty())
        throw UsageError("no sample of the scene's [grid] is in contact: move the grid below the surface");
    return places;
}

TouchedShape scene_shape(const PreparedCase& prepared) {
    constexpr double kDeepestShare = 0.05; // of the box's longest side
    constexpr std::uint64_t kSide = 64;    // voxels
    const Scene& scene = prepared.one.scene;
    TouchedShape shape;
    if (!scene.field && !prepared.images.mesh) {
        PathsSpec paths = scene.paths.value_or(PathsSpec{});
        if (paths.kind == PathKind::recorded)
            paths.kind = PathKind::strokes;
        const PathRegion region = path_region(paths, prepared);
        const double length = region.length / 2, width = region.width / 2, reach = std::max(length, width);
        shape.low = {region.centre[0] - length, region.centre[1] - width, region.height - reach};
        shape.high = {region.centre[0] + length, region.centre[1] + width, region.height + reach};
    } else {
        shape.set_box(scene.field ? scene.grid : fitted_grid(kSide, prepared.images.mesh->mesh));
    }
    const glm::dvec3 size = shape.high - shape.low;
    shape.scale.deepest = std::min(shape.scale.deepest, kDeepestShare * std::max({size.x, size.y, size.z}));
    return shape;
}

void TouchedShape::set_box(const GridSpec& grid) {
    low = sample_place(grid, 0, 0, 0);
    high = sample_place(grid, grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
}

std::optional<TouchPlace> surface_at(const TouchedShape& shape, const PreparedCase& prepared, double x, double y) {
    if (!prepared.images.mesh)
        return on_graph(shape, x, y);
    const Mesh& mesh = prepared.images.mesh->mesh;
    std::optional<TouchPlace> found;
    for (std::size_t i = 0; i < mesh.triangles.corners.size(); ++i) {
        const auto [a, b, c] = corners_of(mesh, i);
        const glm::dvec3 p = b - a, q = c - a, at = glm::dvec3(x, y, 0) - a;
        const double area = p.x * q.y - p.y * q.x, u = (at.x * q.y - at.y * q.x) / area,
                     v = (p.x * at.y - p.y * at.x) / area;
        if (u >= 0 && v >= 0 && u + v <= 1)
            if (const auto place = on_triangle(shape, mesh, i, u, v); place && (!found || place->at.z > found->at.z))
                found = place;
    }
    return found;
}

} // namespace forceshade
