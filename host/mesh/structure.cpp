#include "host/mesh/structure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/surface.h"
#include "host/reference/chunks.h"

namespace forceshade {

namespace {

using layout::uint;

constexpr uint kUnnumbered = 0xFFFFFFFFu;
constexpr std::size_t kMostTriangles = std::size_t(1) << 28; // a leaf names its first in 28 bits

void append(std::vector<double>& table, const glm::dvec3& vector) {
    table.insert(table.end(), {vector.x, vector.y, vector.z});
}

/// The triangles that have an area, with their boxes.
std::vector<TreeItem> tree_items(const Mesh& mesh, const MeshTriangles& triangles, const MeshFrame& frame) {
    std::vector<TreeItem> items;
    items.reserve(triangles.corners.size());
    for (std::size_t triangle = 0; triangle < triangles.corners.size(); ++triangle) {
        if (triangles.normals[triangle] == glm::dvec3(0))
            continue;
        std::array<glm::dvec3, 3> corners;
        std::ranges::transform(triangles.corners[triangle], corners.begin(),
                               [&](uint corner) { return frame.local(mesh.polygons.vertices[corner]); });
        items.push_back(tree_item(static_cast<std::uint32_t>(triangle), corners));
    }
    if (items.empty())
        throw UsageError("the mesh has no facet with an area");
    if (items.size() >= kMostTriangles)
        throw UsageError(
            fmt::format("the mesh has {} triangles; fewer than {} are possible", items.size(), kMostTriangles));
    return items;
}

/// Fills the tables but for neighbours and pseudonormals. Triangles in the tree's order; vertices by first use, so that
/// neighbours lie close in memory.
void number(const Mesh& mesh, const MeshTriangles& triangles, const MeshFrame& frame,
            const std::vector<TreeItem>& items, MeshParts& parts, MeshReals<double>& reals) {
    std::vector<uint> numbers(mesh.polygons.vertices.size(), kUnnumbered), used;
    const auto number_of = [&](uint vertex) {
        if (numbers[vertex] == kUnnumbered) {
            numbers[vertex] = static_cast<uint>(used.size());
            used.push_back(vertex);
        }
        return numbers[vertex];
    };
    parts.triangle_corners.reserve(3 * items.size());
    parts.triangle_facets.reserve(items.size());
    reals.triangle_normals.reserve(3 * items.size());
    for (const TreeItem& item : items) {
        for (const uint corner : triangles.corners[item.triangle])
            parts.triangle_corners.push_back(number_of(corner));
        parts.triangle_facets.push_back(triangles.facets[item.triangle]);
        append(reals.triangle_normals, triangles.normals[item.triangle]);
    }
    parts.facet_begins = mesh.polygons.begins;
    parts.facet_corners.reserve(mesh.polygons.corners.size());
    std::ranges::transform(mesh.polygons.corners, std::back_inserter(parts.facet_corners), number_of);
    reals.vertices.reserve(3 * used.size());
    reals.vertex_normals.reserve(3 * used.size());
    for (const uint vertex : used) {
        append(reals.vertices, frame.local(mesh.polygons.vertices[vertex]));
        append(reals.vertex_normals, mesh.vertex_normals[vertex]);
    }
    reals.facet_normals.reserve(3 * mesh.facet_normals.size());
    for (const glm::dvec3& normal : mesh.facet_normals)
        append(reals.facet_normals, normal);
}

/// A triangle whose corners are collinear once they are rounded has no face any more: the normal that it had need not
/// be across what is left of it.
template <typename T> void drop_normals_of_lines(const std::vector<uint>& corners, MeshReals<T>& reals) {
    constexpr double kBlunt = 1e-20; // square of a sine that no rounding makes of 0
    for (std::size_t i = 0; i < corners.size(); i += 3) {
        const auto at = [&](std::size_t corner) {
            return glm::dvec3(reference::vector_at(std::span<const T>(reals.vertices), corners[i + corner]));
        };
        const glm::dvec3 a = at(0), b = at(1), c = at(2), u = b - a, v = c - a, across = reference::cross(u, v);
        if (reference::dot(across, across) > kBlunt * reference::dot(u, u) * reference::dot(v, v))
            continue;
        if (triangle_normal(a, b, c) == glm::dvec3(0))
            std::fill_n(reals.triangle_normals.begin() + static_cast<std::ptrdiff_t>(i), 3, T(0));
    }
}

/// The tables of one precision out of those of double.
template <typename T>
std::shared_ptr<const MeshReals<T>> reals_as(const std::shared_ptr<const MeshReals<double>>& reals,
                                             const MeshParts& parts) {
    if constexpr (std::is_same_v<T, double>) {
        return reals;
    } else {
        const auto rounded = [](const std::vector<double>& table) {
            return std::vector<T>(table.begin(), table.end());
        };
        auto result = std::make_shared<MeshReals<T>>(MeshReals<T>{
            rounded(reals->vertices), rounded(reals->vertex_normals), rounded(reals->vertex_pseudonormals),
            rounded(reals->triangle_normals), rounded(reals->facet_normals), rounded(reals->edge_pseudonormals)});
        drop_normals_of_lines(parts.triangle_corners, *result);
        return result;
    }
}

} // namespace

std::size_t MeshStructure::bytes() const {
    const auto bytes_of = [](const auto&... tables) { return (... + (tables.capacity() * sizeof(tables.front()))); };
    return bytes_of(parts->nodes, parts->slabs, parts->triangle_corners, parts->triangle_facets,
                    parts->triangle_neighbours, parts->facet_begins, parts->facet_corners) +
           bytes_of(reals->vertices, reals->vertex_normals, reals->vertex_pseudonormals, reals->triangle_normals,
                    reals->facet_normals, reals->edge_pseudonormals) +
           (winding ? bytes_of(winding->moments, winding->rims) : 0);
}

MeshStructure build_structure(const Mesh& mesh, const StructureOptions& options) {
    if (mesh.polygons.corners.empty())
        throw UsageError("the mesh has no facets");
    const unsigned threads = reference::threads_for(options.threads);
    const MeshFrame frame = frame_of(mesh.polygons);
    MeshParts parts;
    MeshReals<double> reals;
    {
        const std::optional<MeshTriangles> surface = make_surface(mesh, frame);
        const MeshTriangles& triangles = surface ? *surface : mesh.triangles;
        std::vector<TreeItem> items = tree_items(mesh, triangles, frame);
        parts.nodes = build_tree(items, std::clamp(options.leaf_triangles, 1u, layout::kMeshLeafTriangles), threads);
        number(mesh, triangles, frame, items, parts, reals);
    }
    bound_by_slabs(parts, reals, threads);
    const std::vector<uint> places = weld(reals.vertices);
    reference::share_out(std::min(threads, 2u), 2, [&](std::size_t, std::size_t step) {
        step == 0 ? sum_pseudonormals(parts, reals, places) : connect_edges(parts, reals, places);
    });
    reals.edge_pseudonormals.shrink_to_fit();
    MeshStructure structure{frame.centre, frame.scale, std::make_shared<const MeshParts>(std::move(parts)),
                            std::make_shared<const MeshReals<double>>(std::move(reals)), nullptr};
    if (options.winding)
        structure.winding = make_winding(structure);
    return structure;
}

void assume_solid(MeshStructure& structure) {
    structure.solid = has_firm_pseudonormals(*structure.parts, *structure.reals);
}

template <typename T> layout::MeshView<T> MeshTables<T>::view() const {
    layout::MeshView<T> view{params,
                             parts->nodes,
                             parts->slabs,
                             reals->vertices,
                             parts->triangle_corners,
                             parts->triangle_facets,
                             parts->triangle_neighbours,
                             reals->triangle_normals,
                             reals->vertex_pseudonormals,
                             reals->edge_pseudonormals,
                             parts->facet_begins,
                             parts->facet_corners,
                             reals->facet_normals,
                             reals->vertex_normals,
                             solid,
                             {},
                             {},
                             {},
                             {}};
    if (winding)
        view.moments = winding->moments, view.rims = winding->rims;
    if (obstacles)
        view.obstacle_begins = obstacles->begins, view.obstacles = obstacles->triangles;
    return view;
}

glm::dvec3 origin_of(const MeshStructure& structure) {
    constexpr double kNear = 4; // scales
    glm::dvec3 origin(0);
    for (int axis = 0; axis < 3; ++axis) {
        const double scales = structure.centre[axis] / structure.scale;
        if (std::abs(scales) >= kNear)
            origin[axis] = std::round(scales) * structure.scale;
    }
    return origin;
}

template <typename T> MeshTables<T> make_mesh_tables(const MeshStructure& structure, double stiffness) {
    const double force = stiffness * structure.scale;
    const auto rounded = static_cast<T>(force);
    const glm::vec<3, T> centre(structure.centre - origin_of(structure)), world(structure.centre);
    if (!std::isnormal(static_cast<T>(structure.scale)) || !(std::isnormal(rounded) || stiffness == 0) ||
        !std::isfinite(world.x + world.y + world.z))
        throw UsageError(fmt::format("a stiffness of {} N/m on a mesh of about {} m makes forces that {} precision "
                                     "cannot hold; a normal number of newtons would be right",
                                     stiffness, structure.scale, sizeof(T) == sizeof(float) ? "single" : "double"));
    MeshTables<T> tables{
        {}, structure.parts, reals_as<T>(structure.reals, *structure.parts), structure.winding, structure.solid, {}};
    tables.params.centre_x = centre.x;
    tables.params.centre_y = centre.y;
    tables.params.centre_z = centre.z;
    tables.params.map_x = world.x;
    tables.params.map_y = world.y;
    tables.params.scale = static_cast<T>(structure.scale);
    tables.params.stiffness = rounded;
    tables.params.facets = static_cast<uint>(structure.parts->facet_begins.size() - 1);
    tables.params.triangles = static_cast<uint>(structure.triangles());
    tables.params.nodes = static_cast<uint>(structure.parts->nodes.size());
    return tables;
}

template MeshTables<float> make_mesh_tables<float>(const MeshStructure&, double);
template MeshTables<double> make_mesh_tables<double>(const MeshStructure&, double);
template struct MeshTables<float>;
template struct MeshTables<double>;

} // namespace forceshade
