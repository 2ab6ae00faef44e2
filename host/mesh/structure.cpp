#include "host/mesh/structure.h"

#include <algorithm>
#include <cmath>
#include <thread>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/surface.h"

namespace forceshade {

namespace {

using layout::uint;

constexpr uint kUnnumbered = 0xFFFFFFFFu;
constexpr std::size_t kMostTriangles = std::size_t(1) << 28; // a leaf names its first in 28 bits

float rounded_down(double value) {
    const auto nearest = static_cast<float>(value);
    return double(nearest) > value ? std::nextafter(nearest, -2.0f) : nearest;
}

float rounded_up(double value) {
    const auto nearest = static_cast<float>(value);
    return double(nearest) < value ? std::nextafter(nearest, 2.0f) : nearest;
}

/// Builds one structure, step by step.
class Assembly {
public:
    Assembly(const Mesh& mesh, unsigned threads)
        : mesh_(mesh), threads_(threads), frame_(frame_of(mesh.polygons)), surface_(make_surface(mesh, frame_)),
          triangles_(surface_ ? *surface_ : mesh.triangles) {}

    void make_tree(unsigned leaf_triangles) {
        const std::vector<glm::dvec3>& vertices = mesh_.polygons.vertices;
        order_.reserve(triangles_.corners.size());
        for (std::size_t triangle = 0; triangle < triangles_.corners.size(); ++triangle) {
            if (triangles_.normals[triangle] == glm::dvec3(0))
                continue;
            TreeItem item{{2, 2, 2}, static_cast<std::uint32_t>(triangle), {-2, -2, -2}, 0};
            for (const uint corner : triangles_.corners[triangle]) {
                const glm::dvec3 at = frame_.local(vertices[corner]);
                for (int axis = 0; axis < 3; ++axis) {
                    float& low = item.low[std::size_t(axis)];
                    float& high = item.high[std::size_t(axis)];
                    low = std::min(low, rounded_down(at[axis]));
                    high = std::max(high, rounded_up(at[axis]));
                }
            }
            order_.push_back(item);
        }
        if (order_.empty())
            throw UsageError("the mesh has no facet with an area");
        if (order_.size() >= kMostTriangles)
            throw UsageError(
                fmt::format("the mesh has {} triangles; fewer than {} are possible", order_.size(), kMostTriangles));
        parts_.nodes = build_tree(order_, leaf_triangles, threads_);
    }

    /// Triangles in the tree's order; vertices by first use, so that neighbours lie close in memory.
    void number() {
        numbers_.assign(mesh_.polygons.vertices.size(), kUnnumbered);
        const std::size_t triangles = order_.size();
        parts_.triangle_corners.reserve(3 * triangles);
        parts_.triangle_facets.reserve(triangles);
        reals_.triangle_normals.reserve(3 * triangles);
        for (const TreeItem& item : order_) {
            for (const uint corner : triangles_.corners[item.triangle])
                parts_.triangle_corners.push_back(number_of(corner));
            parts_.triangle_facets.push_back(triangles_.facets[item.triangle]);
            append(reals_.triangle_normals, triangles_.normals[item.triangle]);
        }
        order_ = {};
        parts_.facet_begins = mesh_.polygons.begins;
        parts_.facet_corners.reserve(mesh_.polygons.corners.size());
        for (const uint corner : mesh_.polygons.corners)
            parts_.facet_corners.push_back(number_of(corner));
        reals_.vertices.reserve(3 * used_.size());
        reals_.vertex_normals.reserve(3 * used_.size());
        for (const uint vertex : used_) {
            append(reals_.vertices, frame_.local(mesh_.polygons.vertices[vertex]));
            append(reals_.vertex_normals, mesh_.vertex_normals[vertex]);
        }
        reals_.facet_normals.reserve(3 * mesh_.facet_normals.size());
        for (const glm::dvec3& normal : mesh_.facet_normals)
            append(reals_.facet_normals, normal);
    }

    void connect() {
        const std::vector<uint> places = weld(reals_.vertices);
        std::jthread other;
        if (threads_ > 1)
            other = std::jthread([&] { sum_pseudonormals(parts_, reals_, places); });
        else
            sum_pseudonormals(parts_, reals_, places);
        connect_edges(parts_, reals_, places);
    }

    MeshStructure finish(bool solid) {
        reals_.edge_pseudonormals.shrink_to_fit();
        parts_.solid = solid && has_firm_pseudonormals(parts_, reals_);
        return {frame_.centre, frame_.scale, std::make_shared<const MeshParts>(std::move(parts_)),
                std::make_shared<const MeshReals<double>>(std::move(reals_)), nullptr};
    }

private:
    static void append(std::vector<double>& table, const glm::dvec3& vector) {
        table.insert(table.end(), {vector.x, vector.y, vector.z});
    }

    uint number_of(uint vertex) {
        if (numbers_[vertex] == kUnnumbered) {
            numbers_[vertex] = static_cast<uint>(used_.size());
            used_.push_back(vertex);
        }
        return numbers_[vertex];
    }

    const Mesh& mesh_;
    unsigned threads_;
    MeshFrame frame_;
    std::optional<MeshTriangles> surface_; // none: the mesh's own triangles
    const MeshTriangles& triangles_;
    std::vector<TreeItem> order_;
    std::vector<uint> numbers_, used_;
    MeshParts parts_;
    MeshReals<double> reals_;
};

/// The tables of one precision out of those of double.
template <typename T>
std::shared_ptr<const MeshReals<T>> reals_as(const std::shared_ptr<const MeshReals<double>>& reals) {
    if constexpr (std::is_same_v<T, double>) {
        return reals;
    } else {
        const auto rounded = [](const std::vector<double>& table) {
            return std::vector<T>(table.begin(), table.end());
        };
        return std::make_shared<const MeshReals<T>>(MeshReals<T>{
            rounded(reals->vertices), rounded(reals->vertex_normals), rounded(reals->vertex_pseudonormals),
            rounded(reals->triangle_normals), rounded(reals->facet_normals), rounded(reals->edge_pseudonormals)});
    }
}

} // namespace

std::size_t MeshStructure::bytes() const {
    const auto bytes_of = [](const auto&... tables) { return (... + (tables.capacity() * sizeof(tables.front()))); };
    return bytes_of(parts->nodes, parts->triangle_corners, parts->triangle_facets, parts->triangle_neighbours,
                    parts->facet_begins, parts->facet_corners) +
           bytes_of(reals->vertices, reals->vertex_normals, reals->vertex_pseudonormals, reals->triangle_normals,
                    reals->facet_normals, reals->edge_pseudonormals) +
           (winding ? bytes_of(winding->moments, winding->rims) : 0);
}

MeshStructure build_structure(const Mesh& mesh, const StructureOptions& options) {
    if (mesh.polygons.corners.empty())
        throw UsageError("the mesh has no facets");
    Assembly assembly(mesh, options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency()));
    assembly.make_tree(std::clamp(options.leaf_triangles, 1u, layout::kMeshLeafTriangles));
    assembly.number();
    assembly.connect();
    MeshStructure structure = assembly.finish(options.solid);
    if (options.winding)
        structure.winding = make_winding(structure);
    return structure;
}

template <typename T> layout::MeshView<T> MeshTables<T>::view() const {
    layout::MeshView<T> view{params,
                             parts->nodes,
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
                             parts->solid,
                             {},
                             {}};
    if (winding)
        view.moments = winding->moments, view.rims = winding->rims;
    return view;
}

template <typename T> MeshTables<T> make_mesh_tables(const MeshStructure& structure, double stiffness) {
    const double force = stiffness * structure.scale;
    const auto rounded = static_cast<T>(force);
    const glm::vec<3, T> centre(structure.centre);
    if (!std::isnormal(static_cast<T>(structure.scale)) || !(std::isnormal(rounded) || stiffness == 0) ||
        !std::isfinite(centre.x + centre.y + centre.z))
        throw UsageError(
            fmt::format("a stiffness of {} N/m on a mesh of about {} m makes forces that {} precision cannot "
                        "hold; a normal number of newtons would be right",
                        stiffness, structure.scale, sizeof(T) == sizeof(float) ? "single" : "double"));
    MeshTables<T> tables{{}, structure.parts, reals_as<T>(structure.reals), structure.winding};
    tables.params.centre_x = centre.x;
    tables.params.centre_y = centre.y;
    tables.params.centre_z = centre.z;
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
