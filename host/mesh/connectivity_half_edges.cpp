#include <algorithm>
#include <vector>

#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include "host/mesh/connectivity.h"

namespace forceshade {
namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    VertexAttributes(0);
    HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
    EdgeAttributes(0);
    FaceAttributes(0);
};
using HalfEdges = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

// Adding a facet searches all edges of its vertices.
bool takes_long(const PolygonSoup& polygons) {
    std::vector<std::uint32_t> facets_at(polygons.vertices.size(), 0);
    for (const std::uint32_t vertex : polygons.corners)
        ++facets_at[vertex];
    double steps = 0;
    for (const double facets : facets_at)
        steps += facets * facets;
    return steps > 100 * static_cast<double>(polygons.corners.size()) + 1e8;
}

bool repeats_a_corner(std::vector<HalfEdges::VertexHandle> corners) {
    std::sort(corners.begin(), corners.end());
    return std::adjacent_find(corners.begin(), corners.end()) != corners.end();
}

bool build(HalfEdges& half_edges, const PolygonSoup& polygons) {
    half_edges.reserve(polygons.vertices.size(), polygons.corners.size(), polygons.facets());
    for (const glm::dvec3& vertex : polygons.vertices)
        half_edges.add_vertex({vertex.x, vertex.y, vertex.z});
    std::vector<HalfEdges::VertexHandle> corners;
    for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
        corners.clear();
        for (std::uint32_t i = polygons.begins[facet]; i < polygons.begins[facet + 1]; ++i)
            corners.emplace_back(static_cast<int>(polygons.corners[i]));
        if (repeats_a_corner(corners) || !half_edges.add_face(corners).is_valid())
            return false;
    }
    return true;
}

std::size_t count_components(const HalfEdges& half_edges) {
    std::vector<bool> seen(half_edges.n_faces(), false);
    std::vector<HalfEdges::FaceHandle> waiting;
    std::size_t components = 0;
    const auto visit = [&](HalfEdges::FaceHandle face) {
        if (!face.is_valid() || seen[static_cast<std::size_t>(face.idx())])
            return false;
        seen[static_cast<std::size_t>(face.idx())] = true;
        waiting.push_back(face);
        return true;
    };
    for (const HalfEdges::FaceHandle first : half_edges.faces()) {
        components += visit(first);
        while (!waiting.empty()) {
            const HalfEdges::FaceHandle face = waiting.back();
            waiting.pop_back();
            for (const HalfEdges::HalfedgeHandle half_edge : half_edges.fh_range(face))
                visit(half_edges.face_handle(half_edges.opposite_halfedge_handle(half_edge)));
        }
    }
    return components;
}

// Half-edges without a facet, and the loops that they form.
void count_boundary(const HalfEdges& half_edges, Connectivity& found) {
    std::vector<bool> seen(half_edges.n_halfedges(), false);
    for (const HalfEdges::HalfedgeHandle first : half_edges.halfedges()) {
        if (!half_edges.is_boundary(first) || seen[static_cast<std::size_t>(first.idx())])
            continue;
        ++found.holes;
        for (HalfEdges::HalfedgeHandle half_edge = first; !seen[static_cast<std::size_t>(half_edge.idx())];
             half_edge = half_edges.next_halfedge_handle(half_edge)) {
            seen[static_cast<std::size_t>(half_edge.idx())] = true;
            ++found.boundary_edges;
        }
    }
}

} // namespace

std::optional<Connectivity> connectivity_by_half_edges(const PolygonSoup& polygons) {
    constexpr std::size_t kMost = 0x7FFFFFFF / 2; // handles are ints
    if (polygons.vertices.size() > kMost || polygons.corners.size() > kMost || takes_long(polygons))
        return std::nullopt;
    ::omerr().disable(); // it speaks of every facet that it refuses
    HalfEdges half_edges;
    if (!build(half_edges, polygons))
        return std::nullopt;
    for (const HalfEdges::VertexHandle vertex : half_edges.vertices())
        if (!half_edges.is_isolated(vertex) && !half_edges.is_manifold(vertex))
            return std::nullopt;
    Connectivity found;
    found.components = count_components(half_edges);
    count_boundary(half_edges, found);
    found.odd_edges = found.boundary_edges;
    return found;
}

} // namespace forceshade
