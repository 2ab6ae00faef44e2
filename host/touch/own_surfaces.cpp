#include "host/touch/own_surfaces.h"

#include <algorithm>
#include <cmath>

#include "host/mesh/mesh.h"
#include "host/reference/elementary.h"

namespace forceshade {
namespace {

constexpr double kBeyond = 1.5; /* of a */
constexpr double kFloor = 4;    /* of a: how deep the block is */

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
    const double a = bump.half_width, step = 2 * a / bump.cells, row = 2 * a / bump.rows; /* m */
    const double foot = reference::circle_rise(bump.radius, a);                           /* m */
    const auto margin = static_cast<std::uint32_t>(std::max(1.0, std::round((kBeyond - 1) * a / step)));
    const Lattice lattice{bump.cells + 2 * margin, bump.rows};
    const auto along = [&](std::uint32_t i) { // symmetric to the last bit
        return step * (static_cast<double>(i) - static_cast<double>(lattice.columns) / 2);
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
    for (std::uint32_t i = 0; i < lattice.columns; ++i)
        for (std::uint32_t j = 0; j < lattice.rows; ++j)
            add_fan(block, {lattice.at(i, j), lattice.at(i + 1, j), lattice.at(i + 1, j + 1), lattice.at(i, j + 1)});
    add_walls(block, lattice, along(lattice.columns), across(lattice.rows), -kFloor * a);
    for (glm::dvec3& vertex : block.vertices)
        vertex += shift;
    auto mesh = std::make_shared<SceneMesh>();
    mesh->findings = inspect(block);
    mesh->mesh = prepare_mesh(std::move(block), MeshPlacement{}, VertexNormals::plain);
    mesh->structure = build_structure(mesh->mesh);
    if (is_solid(mesh->findings))
        assume_solid(mesh->structure);
    return mesh;
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
    if (own.kind == SurfaceKind::mesh) {
        surface.mesh.file = "bump";
        prepared.images.mesh = bump_mesh({kOwnHalfWidth, own.radius, own.facets, own.rows}, shift);
    }
    return prepared;
}

} // namespace forceshade
