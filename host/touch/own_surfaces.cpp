#include "host/touch/own_surfaces.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <numbers>

#include <glm/vec2.hpp>

#include "host/mesh/mesh.h"
#include "host/random.h"
#include "host/reference/elementary.h"

namespace forceshade {

namespace {

constexpr double kBeyond = 1.5;    /* of the angle of a */
constexpr double kSteepest = 1.25; /* rad: of the top, where cells are small enough */
constexpr double kFloor = 4;       /* of a: how deep the block is */

using Corners = std::vector<std::uint32_t>;

/// A convex polygon as a fan of triangles about its first corner.
void add_fan(PolygonSoup& block, const Corners& corners) {
    for (std::size_t i = 1; i + 1 < corners.size(); ++i) {
        block.corners.insert(block.corners.end(), {corners[0], corners[i], corners[i + 1]});
        block.end_facet();
    }
}

/// Columns of vertices along y for each x; the top's vertex (i, j).
struct Lattice {
    std::uint32_t columns, rows; /* cells */
    std::uint32_t at(std::uint32_t i, std::uint32_t j) const { return i * (rows + 1) + j; }
};

/// Two triangles a cell.
void add_cells(PolygonSoup& soup, const Lattice& lattice) {
    for (std::uint32_t i = 0; i < lattice.columns; ++i)
        for (std::uint32_t j = 0; j < lattice.rows; ++j)
            add_fan(soup, {lattice.at(i, j), lattice.at(i + 1, j), lattice.at(i + 1, j + 1), lattice.at(i, j + 1)});
}

void add_walls(PolygonSoup& block, const Lattice& lattice, double x, double y, double z) {
    const auto low = static_cast<std::uint32_t>(block.vertices.size());
    for (const auto& [sx, sy] : {std::pair(-1, -1), {1, -1}, {1, 1}, {-1, 1}})
        block.vertices.push_back({sx * x, sy * y, z});
    const std::uint32_t m = lattice.columns, n = lattice.rows;
    Corners front{low, low + 1}, right{low + 1, low + 2}, back{low + 2, low + 3}, left{low + 3, low};
    for (std::uint32_t i = m + 1; i-- > 0;)
        front.push_back(lattice.at(i, 0));
    for (std::uint32_t i = 0; i <= m; ++i)
        back.push_back(lattice.at(i, n));
    for (std::uint32_t j = n + 1; j-- > 0;)
        right.push_back(lattice.at(m, j));
    for (std::uint32_t j = 0; j <= n; ++j)
        left.push_back(lattice.at(0, j));
    for (const Corners* wall : {&front, &right, &back, &left})
        add_fan(block, *wall);
    add_fan(block, {low + 3, low + 2, low + 1, low});
}

} // namespace

std::shared_ptr<const SceneMesh> bump_mesh(const BumpMesh& bump, const glm::dvec3& shift) {
    const double a = bump.half_width, row = 2 * a / bump.rows;  /* m */
    const double foot = reference::circle_rise(bump.radius, a); /* m */
    const double half = std::asin(a / bump.radius), arc = 2 * half / bump.cells;
    const double beyond = std::min(kBeyond * half, kSteepest) - half;
    const auto margin = static_cast<std::uint32_t>(std::max(1.0, std::round(beyond / arc)));
    assert(half + margin * arc < std::numbers::pi / 2);
    const Lattice lattice{bump.cells + 2 * margin, bump.rows};
    const auto along = [&](std::uint32_t i) { // symmetric to the last bit
        return bump.radius * std::sin(arc * (static_cast<double>(i) - static_cast<double>(lattice.columns) / 2));
    };
    const auto across = [&](std::uint32_t j) {
        return row * (static_cast<double>(j) - static_cast<double>(lattice.rows) / 2);
    };
    PolygonSoup block;
    for (std::uint32_t i = 0; i <= lattice.columns; ++i)
        for (std::uint32_t j = 0; j <= lattice.rows; ++j) {
            const double x = along(i);
            block.vertices.push_back(
                {x, across(j), (a - x) * (a + x) / (reference::circle_rise(bump.radius, x) + foot)});
        }
    add_cells(block, lattice);
    add_walls(block, lattice, along(lattice.columns), across(lattice.rows), -kFloor * a);
    for (glm::dvec3& vertex : block.vertices)
        vertex += shift;
    return made_mesh(std::move(block));
}

// The patch.

namespace {

// Cells on the unrolled cylinder, from its middle: a grid that ends with the patch, or one that is turned and moved and
// goes further.
struct Cells {
    unsigned along, across;    // the number of them
    glm::dvec2 size, moved{0}; /* m; cells */
    double cosine = 1, sine = 0;

    glm::dvec2 vertex(unsigned i, unsigned j) const {
        const glm::dvec2 at = size * (glm::dvec2(i, j) - 0.5 * glm::dvec2(along, across) + moved);
        return {cosine * at.x - sine * at.y, sine * at.x + cosine * at.y};
    }
};

std::shared_ptr<const SceneMesh> mesh_of(const Cells& cells, double radius, double centre_depth) {
    PolygonSoup patch;
    const Lattice lattice{cells.along, cells.across};
    for (unsigned i = 0; i <= cells.along; ++i)
        for (unsigned j = 0; j <= cells.across; ++j) {
            const glm::dvec2 at = cells.vertex(i, j);
            patch.vertices.emplace_back(radius * std::sin(at.x / radius), at.y,
                                        radius * std::cos(at.x / radius) - centre_depth);
        }
    add_cells(patch, lattice);
    return made_mesh(std::move(patch));
}

} // namespace

std::shared_ptr<const SceneMesh> cylinder_patch(const BumpMesh& bump, const std::optional<DrawnPatch>& drawn) {
    const double a = bump.half_width, radius = bump.radius;
    Cells cells{bump.cells, bump.rows,
                2.0 * glm::dvec2(radius * std::asin(a / radius), a) / glm::dvec2(bump.cells, bump.rows)};
    if (drawn) {
        Random random(drawn->seed);
        const auto enough = [&](double size) { return 2 * static_cast<unsigned>(std::ceil(drawn->reach / size) + 1); };
        cells.along = enough(cells.size.x);
        cells.across = enough(cells.size.y);
        cells.moved = {random(0, 1), random(0, 1)};
        const double turn = random(0, 2 * std::numbers::pi);
        cells.cosine = std::cos(turn);
        cells.sine = std::sin(turn);
    }
    return mesh_of(cells, radius, std::sqrt((radius - a) * (radius + a)));
}

PreparedCase own_case(const OwnSurface& own, const glm::dvec3& shift) {
    PreparedCase prepared;
    Scene& scene = prepared.one.scene;
    SurfaceSpec& surface = scene.surface;
    surface.kind = own.kind;
    surface.width = surface.map.width = 2 * kOwnHalfWidth;
    surface.radius = surface.map.radius = own.radius;
    surface.facets = own.facets;
    surface.map.function = own.function;
    if (own.function == MapFunction::sine) {
        surface.map.width = kOwnWavelength;
        surface.map.height = 0.001;
    }
    scene.force.stiffness = own.stiffness;
    if (own.shaded)
        scene.force.shading = own.kind == SurfaceKind::height_map ? Shading::height_map
                              : own.kind == SurfaceKind::mesh     ? Shading::mean_value
                                                                  : Shading::reference;
    scene.force.shading = own.shading.value_or(scene.force.shading);
    if (own.texture > 0) {
        TextureSpec& sine = scene.texture.emplace();
        sine.stiffness = own.stiffness;
        sine.map.function = MapFunction::sine;
        sine.map.width = 0.002;
        sine.map.height = own.texture;
    }
    if (own.kind == SurfaceKind::mesh) {
        surface.mesh.file = "bump";
        prepared.images.mesh = bump_mesh({kOwnHalfWidth, own.radius, own.facets, own.rows}, shift);
    }
    return prepared;
}

std::vector<StudiedSurface> studied_surfaces(Examined what) {
    std::vector<StudiedSurface> some;
    for (const StudiedSurface& one : kStudiedSurfaces)
        if (one.examined & what)
            some.push_back(one);
    return some;
}

GridSpec grid_over(const TouchedBox& box, const std::array<std::uint64_t, 3>& size) {
    GridSpec grid;
    grid.size = size;
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto i = static_cast<int>(axis);
        grid.origin[axis] = box.low[i];
        grid.spacing[axis] = (box.high[i] - box.low[i]) / static_cast<double>(size[axis] - 1);
    }
    return grid;
}

} // namespace forceshade
