#include "host/mesh/connectivity.h"

#include <algorithm>
#include <cstdint>
#include <span>
#include <vector>

#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

namespace forceshade {

namespace {

// One facet's side along an edge: the corners (places in PolygonSoup::corners) where it begins and ends.
struct Side {
    std::uint64_t edge; // lesser vertex * 2^32 + greater vertex
    std::uint32_t begin, end;
};

class EdgeMatching {
public:
    explicit EdgeMatching(const PolygonSoup& polygons)
        : polygons_(polygons), fans_(polygons.corners.size()), pieces_(polygons.facets()),
          facet_of_(polygons.corners.size()) {}

    Connectivity run() {
        collect_sides();
        std::ranges::sort(sides_, {}, [](const Side& side) { return std::pair(side.edge, side.begin); });
        for (std::size_t i = 0; i < sides_.size();) {
            std::size_t end = i + 1;
            while (end < sides_.size() && sides_[end].edge == sides_[i].edge)
                ++end;
            match(std::span(sides_).subspan(i, end - i));
            i = end;
        }
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet)
            found_.components += pieces_.find(facet) == facet;
        count_fans();
        count_holes();
        return found_;
    }

private:
    std::uint32_t vertex(std::uint32_t corner) const { return polygons_.corners[corner]; }

    void collect_sides() {
        sides_.reserve(polygons_.corners.size());
        for (std::uint32_t facet = 0; facet < polygons_.facets(); ++facet) {
            const std::uint32_t first = polygons_.begins[facet], last = polygons_.begins[facet + 1] - 1;
            for (std::uint32_t begin = first; begin <= last; ++begin) {
                const std::uint32_t end = begin == last ? first : begin + 1;
                const std::uint64_t a = vertex(begin), b = vertex(end);
                facet_of_[begin] = facet;
                if (a == b)
                    fans_.join(begin, end);
                else
                    sides_.push_back({std::min(a, b) << 32 | std::max(a, b), begin, end});
            }
        }
    }

    void match(std::span<const Side> sides) {
        found_.non_manifold_edges += sides.size() > 2;
        found_.odd_edges += sides.size() % 2;
        found_.misoriented_edges += sides.size() == 2 && vertex(sides[0].begin) == vertex(sides[1].begin);
        if (sides.size() == 1) {
            ++found_.boundary_edges;
            border_.push_back(sides[0]);
        }
        for (const Side& side : sides.subspan(1)) {
            const bool same = vertex(side.begin) == vertex(sides[0].begin);
            fans_.join(sides[0].begin, same ? side.begin : side.end);
            fans_.join(sides[0].end, same ? side.end : side.begin);
            pieces_.join(facet_of_[sides[0].begin], facet_of_[side.begin]);
        }
    }

    void count_fans() {
        std::vector<std::uint32_t> fans(polygons_.vertices.size(), 0);
        for (std::uint32_t corner = 0; corner < polygons_.corners.size(); ++corner)
            if (fans_.find(corner) == corner && ++fans[vertex(corner)] == 2)
                ++found_.non_manifold_vertices;
    }

    // Boundary edges that end in the same fan belong to the same loop.
    void count_holes() {
        DisjointSets loops(polygons_.corners.size());
        for (const Side& side : border_)
            loops.join(fans_.find(side.begin), fans_.find(side.end));
        std::vector<std::uint32_t> names;
        names.reserve(border_.size());
        for (const Side& side : border_)
            names.push_back(loops.find(fans_.find(side.begin)));
        std::ranges::sort(names);
        const auto repeated = std::ranges::unique(names);
        found_.holes = names.size() - repeated.size();
    }

    const PolygonSoup& polygons_;
    DisjointSets fans_;   // corners of a vertex, joined across edges
    DisjointSets pieces_; // facets
    std::vector<std::uint32_t> facet_of_;
    std::vector<Side> sides_, border_;
    Connectivity found_;
};

} // namespace

Connectivity connectivity_by_edges(const PolygonSoup& polygons) {
    return EdgeMatching(polygons).run();
}

Connectivity connectivity(const PolygonSoup& polygons) {
    if (const auto found = connectivity_by_half_edges(polygons))
        return *found;
    return connectivity_by_edges(polygons);
}

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
