// The tables of a mesh, and what decides inside or outside of it: the pseudonormals of edges and vertices (Baerentzen
// and Aanaes 2005), and the generalized winding number (Jacobson et al. 2013) by a tree of moments far away (Barill et
// al. 2018).
#include "host/mesh/structure.h"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "host/error.h"
#include "host/mesh/clearance.h"
#include "host/mesh/places.h"
#include "host/reference/chunks.h"
#include "host/reference/elementary.h"
#include "host/reference/mesh_contact.h"
#include "host/reference/mesh_nearest.h"

namespace forceshade {

namespace {

using layout::uint;

constexpr uint kUnnumbered = 0xFFFFFFFFu;
constexpr std::size_t kMostTriangles = std::size_t(1) << 28; // a leaf names its first in 28 bits

void append(std::vector<double>& table, const glm::dvec3& vector) {
    table.insert(table.end(), {vector.x, vector.y, vector.z});
}

/// Shares out work(i) for every i below count, many at a time.
template <typename Work> void share_each(unsigned threads, std::size_t count, const Work& work) {
    constexpr std::size_t kRun = 4096;
    reference::share_out(threads, (count + kRun - 1) / kRun, [&](std::size_t, std::size_t run) {
        for (std::size_t i = run * kRun; i < std::min(count, (run + 1) * kRun); ++i)
            work(i);
    });
}

/// The triangles that have an area, with their boxes.
std::vector<TreeItem> tree_items(const Mesh& mesh, const MeshTriangles& triangles, const MeshFrame& frame,
                                 unsigned threads) {
    std::vector<TreeItem> items(triangles.corners.size());
    share_each(threads, items.size(), [&](std::size_t triangle) {
        std::array<glm::dvec3, 3> corners;
        std::ranges::transform(triangles.corners[triangle], corners.begin(),
                               [&](uint corner) { return frame.local(mesh.polygons.vertices[corner]); });
        items[triangle] = tree_item(static_cast<std::uint32_t>(triangle), corners);
    });
    std::erase_if(items, [&](const TreeItem& item) { return triangles.normals[item.triangle] == glm::dvec3(0); });
    if (items.empty())
        throw UsageError("the mesh has no facet with an area");
    if (items.size() >= kMostTriangles)
        throw UsageError("the mesh has {} triangles; fewer than {} are possible", items.size(), kMostTriangles);
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

glm::dvec3 vector_at(const std::vector<double>& table, std::size_t index) {
    return reference::vector_at<double>(table, index);
}

/// The corner at which an edge (3 * triangle + i, the corner where it starts) ends.
std::size_t following(std::size_t edge) {
    return edge % 3 == 2 ? edge - 2 : edge + 1;
}

/// Calls use(edges) with all edges between one pair of places, pair by pair.
template <typename Use>
void for_each_bundle(const std::vector<uint>& corners, const std::vector<uint>& places, const Use& use) {
    const auto ends = [&](std::size_t edge) {
        return std::pair(places[corners[edge]], places[corners[following(edge)]]);
    };
    forceshade::for_each_bundle(places.size(), corners.size(), ends, use);
}

/// Fills parts.triangle_neighbours and reals.edge_pseudonormals. Edges are matched by the places of their ends.
void connect_edges(MeshParts& parts, MeshReals<double>& reals, const std::vector<uint>& places) {
    std::vector<uint>& across = parts.triangle_neighbours;
    across.resize(parts.triangle_corners.size());
    for_each_bundle(parts.triangle_corners, places, [&](std::span<const uint> edges) {
        if (edges.size() == 1) {
            across[edges[0]] = layout::kMeshBorder;
            return;
        }
        if (edges.size() == 2 && edges[0] / 3 != edges[1] / 3) {
            across[edges[0]] = edges[1] / 3;
            across[edges[1]] = edges[0] / 3;
            return;
        }
        glm::dvec3 sum(0.0);
        for (const uint edge : edges)
            sum += vector_at(reals.triangle_normals, edge / 3);
        const auto entry = static_cast<uint>(reals.edge_pseudonormals.size() / 3);
        reals.edge_pseudonormals.insert(reals.edge_pseudonormals.end(), {sum.x, sum.y, sum.z});
        for (const uint edge : edges)
            across[edge] = layout::kMeshManyBit | entry;
    });
}

/// Fills reals.vertex_pseudonormals: for each place the sum of its triangles' normals, weighted by the angle there
/// (Baerentzen and Aanaes 2005).
void sum_pseudonormals(const MeshParts& parts, MeshReals<double>& reals, const std::vector<uint>& places) {
    std::vector<double>& sums = reals.vertex_pseudonormals;
    sums.assign(reals.vertices.size(), 0.0);
    for (std::size_t triangle = 0; triangle < parts.triangle_facets.size(); ++triangle) {
        const uint* corners = &parts.triangle_corners[3 * triangle];
        glm::dvec3 at[3];
        for (std::size_t i = 0; i < 3; ++i)
            at[i] = vector_at(reals.vertices, corners[i]);
        const glm::dvec3 normal = vector_at(reals.triangle_normals, triangle);
        for (std::size_t i = 0; i < 3; ++i) {
            const double angle = reference::angle_between(at[(i + 1) % 3] - at[i], at[(i + 2) % 3] - at[i]);
            double* sum = &sums[3 * std::size_t(places[corners[i]])];
            sum[0] += angle * normal.x;
            sum[1] += angle * normal.y;
            sum[2] += angle * normal.z;
        }
    }
    for (std::size_t vertex = 0; vertex < places.size(); ++vertex)
        std::copy_n(&sums[3 * std::size_t(places[vertex])], 3, &sums[3 * vertex]);
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
    bool has_all = false; // of the mesh's triangles
    {
        const std::optional<MeshTriangles> surface = make_surface(mesh, frame);
        const MeshTriangles& triangles = surface ? *surface : mesh.triangles;
        std::vector<TreeItem> items = tree_items(mesh, triangles, frame, threads);
        parts.nodes = build_tree(items, std::clamp(options.leaf_triangles, 1u, layout::kMeshLeafTriangles), threads);
        number(mesh, triangles, frame, items, parts, reals);
        has_all = !surface && items.size() == triangles.corners.size();
    }
    bound_by_slabs(parts, reals, threads);
    const std::vector<uint> places = weld(reals.vertices);
    reference::share_out(std::min(threads, 2u), 2, [&](std::size_t, std::size_t step) {
        step == 0 ? sum_pseudonormals(parts, reals, places) : connect_edges(parts, reals, places);
    });
    reals.edge_pseudonormals.shrink_to_fit();
    MeshStructure structure{frame.centre,
                            frame.scale,
                            std::make_shared<const MeshParts>(std::move(parts)),
                            std::make_shared<const MeshReals<double>>(std::move(reals)),
                            nullptr,
                            false,
                            nullptr};
    if (has_all)
        structure.clearance = std::make_shared<const Clearance>(structure.parts, structure.reals);
    if (options.winding)
        structure.winding = make_winding(structure);
    return structure;
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
                             clearance.get(),
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
        throw UsageError("a stiffness of {} N/m on a mesh of about {} m makes forces that {} precision "
                         "cannot hold; a normal number of newtons would be right",
                         stiffness, structure.scale, sizeof(T) == sizeof(float) ? "single" : "double");
    MeshTables<T> tables{{},
                         structure.parts,
                         reals_as<T>(structure.reals, *structure.parts),
                         structure.winding,
                         structure.solid,
                         structure.clearance,
                         {}};
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

void assume_solid(MeshStructure& structure) {
    constexpr double kFirm = 0x1p-14; // of the square of the length
    const auto is_firm = [](const glm::dvec3& sum) { return reference::dot(sum, sum) > kFirm; };
    const MeshReals<double>& reals = *structure.reals;
    const std::vector<uint>& neighbours = structure.parts->triangle_neighbours;
    structure.solid = true;
    for (std::size_t vertex = 0; vertex < reals.vertex_pseudonormals.size() / 3 && structure.solid; ++vertex)
        structure.solid = is_firm(vector_at(reals.vertex_pseudonormals, vertex));
    for (std::size_t edge = 0; edge < neighbours.size() && structure.solid; ++edge)
        structure.solid =
            (neighbours[edge] & layout::kMeshManyBit) == 0 && // nor a border
            is_firm(vector_at(reals.triangle_normals, edge / 3) + vector_at(reals.triangle_normals, neighbours[edge]));
    if (structure.solid && !structure.clearance)
        structure.clearance = std::make_shared<const Clearance>(structure.parts, structure.reals);
}

namespace {

/// Edges that triangles run along more often in one direction than in the other, three numbers each: two vertices and
/// by how often.
std::vector<uint> find_rims(const MeshParts& parts, const std::vector<uint>& places) {
    std::vector<uint> rims;
    const std::vector<uint>& corners = parts.triangle_corners;
    for_each_bundle(corners, places, [&](std::span<const uint> edges) {
        const uint start = corners[edges[0]], stop = corners[following(edges[0])];
        long surplus = 0; // towards the higher place
        for (const uint edge : edges)
            surplus += places[corners[edge]] == std::max(places[start], places[stop]) ? -1 : 1;
        if (surplus != 0 && places[start] != places[stop])
            rims.insert(rims.end(), {start, stop, static_cast<uint>(std::abs(surplus))});
    });
    return rims;
}

glm::dvec3 vector_of(const double (&numbers)[3]) {
    return {numbers[0], numbers[1], numbers[2]};
}

/// Where the part i, j (or i, j, k) of a symmetric moment stands.
std::size_t place(std::size_t i, std::size_t j) {
    constexpr std::size_t kPlaces[3][3] = {{0, 3, 4}, {3, 1, 5}, {4, 5, 2}};
    return kPlaces[i][j];
}
std::size_t place(std::size_t i, std::size_t j, std::size_t k) {
    // By how often y and z come.
    constexpr std::size_t kPlaces[4][4] = {{0, 4, 7, 2}, {3, 9, 8, 0}, {5, 6, 0, 0}, {1, 0, 0, 0}};
    const std::size_t y = (i == 1) + (j == 1) + (k == 1), z = (i == 2) + (j == 2) + (k == 2);
    return kPlaces[y][z];
}

/// One of the triangles or nodes below a node: its moments about its own centre.
struct Part {
    layout::MeshMoment moment;
    double area;
};

/// Adds a part's moments to those about another centre.
void add(const layout::MeshMoment& part, layout::MeshMoment& sum) {
    double t[3];
    for (std::size_t i = 0; i < 3; ++i)
        t[i] = part.centre[i] - sum.centre[i];
    const double* d = part.dipole;
    const double* q = part.quadrupole;
    for (std::size_t i = 0; i < 3; ++i) {
        sum.dipole[i] += d[i];
        for (std::size_t j = i; j < 3; ++j) {
            sum.quadrupole[place(i, j)] += q[place(i, j)] + (d[i] * t[j] + d[j] * t[i]) / 2;
            for (std::size_t k = j; k < 3; ++k)
                sum.octupole[place(i, j, k)] +=
                    part.octupole[place(i, j, k)] +
                    (2 * (q[place(i, j)] * t[k] + q[place(i, k)] * t[j] + q[place(j, k)] * t[i]) +
                     (d[i] * t[j] * t[k] + d[j] * t[i] * t[k] + d[k] * t[i] * t[j])) /
                        3;
        }
    }
    sum.radius = std::max(sum.radius, reference::length(glm::dvec3(t[0], t[1], t[2])) + part.radius);
}

Part part_of_triangle(const MeshStructure& structure, std::size_t triangle) {
    glm::dvec3 corners[3];
    for (std::size_t i = 0; i < 3; ++i)
        corners[i] = vector_at(structure.reals->vertices, structure.parts->triangle_corners[3 * triangle + i]);
    const glm::dvec3 centre = (corners[0] + corners[1] + corners[2]) / 3.0;
    const glm::dvec3 area =
        reference::cross(glm::dvec3(corners[1] - corners[0]), glm::dvec3(corners[2] - corners[0])) / 2.0;
    Part part{{{centre.x, centre.y, centre.z}, 0, {area.x, area.y, area.z}, {}, {}}, reference::length(area)};
    double spread[3][3] = {}; // mean of x_j x_k over the triangle
    for (const glm::dvec3& corner : corners) {
        const glm::dvec3 from = corner - centre;
        part.moment.radius = std::max(part.moment.radius, reference::length(from));
        for (int j = 0; j < 3; ++j)
            for (int k = 0; k < 3; ++k)
                spread[j][k] += from[j] * from[k] / 12;
    }
    const double* d = part.moment.dipole;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = i; j < 3; ++j)
            for (std::size_t k = j; k < 3; ++k)
                part.moment.octupole[place(i, j, k)] =
                    (d[i] * spread[j][k] + d[j] * spread[i][k] + d[k] * spread[i][j]) / 3;
    return part;
}

/// Of a node, from its triangles and from the nodes below it.
Part part_of_node(const MeshStructure& structure, const layout::MeshNode& node, const std::vector<Part>& nodes) {
    std::vector<Part> parts;
    for (const uint child : node.child) {
        if (child == layout::kMeshNoChild)
            continue;
        if ((child & layout::kMeshLeaf) == 0) {
            parts.push_back(nodes[child]);
            continue;
        }
        const uint run = child & ~layout::kMeshLeaf;
        for (uint i = 0; i <= run % layout::kMeshLeafTriangles; ++i)
            parts.push_back(part_of_triangle(structure, run / layout::kMeshLeafTriangles + i));
    }
    double area = 0;
    glm::dvec3 centre(0.0);
    for (const Part& part : parts) {
        area += part.area;
        centre += part.area * vector_of(part.moment.centre);
    }
    centre = area > 0 ? centre / area : vector_of(parts.front().moment.centre);
    Part sum{{{centre.x, centre.y, centre.z}, 0, {}, {}, {}}, area};
    for (const Part& part : parts)
        add(part.moment, sum.moment);
    return sum;
}

} // namespace

std::shared_ptr<const MeshWinding> make_winding(const MeshStructure& structure) {
    const std::vector<layout::MeshNode>& nodes = structure.parts->nodes;
    std::vector<Part> parts(nodes.size());
    for (std::size_t i = nodes.size(); i-- > 0;) // children stand behind their parents
        parts[i] = part_of_node(structure, nodes[i], parts);
    MeshWinding winding{{}, find_rims(*structure.parts, weld(structure.reals->vertices))};
    winding.moments.reserve(parts.size());
    for (const Part& part : parts)
        winding.moments.push_back(part.moment);
    return std::make_shared<const MeshWinding>(std::move(winding));
}

double winding_behind(const MeshStructure& structure) {
    constexpr std::size_t kMost = 256;
    const MeshTables<double> tables = make_mesh_tables<double>(structure, 0);
    const layout::MeshView<double> mesh = tables.view();
    const std::size_t count = std::min(structure.triangles(), kMost);
    std::vector<double> numbers;
    for (std::size_t i = 0; i < count; ++i) {
        const auto index = static_cast<uint>(i * structure.triangles() / count);
        const auto triangle = reference::triangle_at(mesh, index);
        const auto& [a, b, c] = triangle.corners;
        const glm::dvec3 sides = b - a, other = c - a;
        const double size = std::sqrt(std::sqrt(reference::dot(sides, sides) * reference::dot(other, other)));
        numbers.push_back(reference::winding_number(mesh, (a + b + c) / 3.0 - 1e-3 * size * triangle.normal));
    }
    std::ranges::nth_element(numbers, numbers.begin() + static_cast<std::ptrdiff_t>(count / 2));
    return numbers[count / 2];
}

} // namespace forceshade
