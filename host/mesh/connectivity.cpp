#include "host/mesh/connectivity.h"

#include <algorithm>
#include <numeric>

#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include "host/mesh/surface.h"

namespace forceshade {

namespace {

struct DoubleTraits : OpenMesh::DefaultTraits {
    using Point = OpenMesh::Vec3d;
    VertexAttributes(0);
    HalfedgeAttributes(OpenMesh::Attributes::PrevHalfedge);
    EdgeAttributes(0);
    FaceAttributes(0);
};
using Kernel = OpenMesh::PolyMesh_ArrayKernelT<DoubleTraits>;

template <typename Handle> std::uint32_t number(Handle handle) {
    return static_cast<std::uint32_t>(handle.idx());
}

class HalfEdges final : public Connectivity::Structure {
public:
    /// Null if OpenMesh cannot represent the polygons.
    static std::unique_ptr<const HalfEdges> build(const PolygonSoup& polygons) {
        constexpr std::size_t kMost = 0x7FFFFFFF / 2; // handles are ints
        if (polygons.vertices.size() > kMost || polygons.corners.size() > kMost || is_slow(polygons))
            return nullptr;
        auto result = std::make_unique<HalfEdges>();
        return result->add(polygons) ? std::move(result) : nullptr;
    }

    ConnectivityCounts counts() const override {
        ConnectivityCounts found;
        DisjointSets pieces(mesh_.n_faces());
        for (const auto edge : mesh_.edges()) {
            const auto one = mesh_.face_handle(mesh_.halfedge_handle(edge, 0)),
                       other = mesh_.face_handle(mesh_.halfedge_handle(edge, 1));
            if (one.is_valid() && other.is_valid())
                pieces.join(number(one), number(other));
        }
        found.components = pieces.count();
        std::vector<bool> seen(mesh_.n_halfedges(), false);
        for (const Kernel::HalfedgeHandle first : mesh_.halfedges()) {
            if (!mesh_.is_boundary(first) || seen[number(first)])
                continue;
            ++found.holes;
            for (auto edge = first; !seen[number(edge)]; edge = mesh_.next_halfedge_handle(edge)) {
                seen[number(edge)] = true;
                ++found.boundary_edges;
            }
        }
        found.odd_edges = found.boundary_edges;
        return found;
    }

    void fan(std::uint32_t vertex, std::vector<FacetCorner>& corners) const override {
        corners.clear();
        for (const auto edge : mesh_.voh_range(mesh_.vertex_handle(vertex)))
            if (!mesh_.is_boundary(edge))
                corners.push_back({number(mesh_.face_handle(edge)),
                                   number(mesh_.from_vertex_handle(mesh_.prev_halfedge_handle(edge))), vertex,
                                   number(mesh_.to_vertex_handle(edge))});
        std::ranges::sort(corners, {}, &FacetCorner::facet); // OpenMesh begins anywhere
    }

private:
    // Adding a facet searches all edges of its vertices.
    static bool is_slow(const PolygonSoup& polygons) {
        std::vector<std::uint32_t> facets_at(polygons.vertices.size(), 0);
        for (const std::uint32_t vertex : polygons.corners)
            ++facets_at[vertex];
        double steps = 0;
        for (const double facets : facets_at)
            steps += facets * facets;
        return steps > 100 * static_cast<double>(polygons.corners.size()) + 1e8;
    }

    bool add(const PolygonSoup& polygons) {
        // It speaks of every facet that it refuses; its first call is not made for threads.
        [[maybe_unused]] static const bool kQuiet = (::omerr().disable(), true);
        mesh_.reserve(polygons.vertices.size(), polygons.corners.size(), polygons.facets());
        for (const glm::dvec3& vertex : polygons.vertices)
            mesh_.add_vertex({vertex.x, vertex.y, vertex.z});
        std::vector<Kernel::VertexHandle> corners, sorted;
        for (std::size_t facet = 0; facet < polygons.facets(); ++facet) {
            corners.clear();
            for (std::uint32_t i = polygons.begins[facet]; i < polygons.begins[facet + 1]; ++i)
                corners.emplace_back(static_cast<int>(polygons.corners[i]));
            sorted = corners;
            std::sort(sorted.begin(), sorted.end());
            if (corners.size() < 3 || std::adjacent_find(sorted.begin(), sorted.end()) != sorted.end() ||
                !mesh_.add_face(corners).is_valid())
                return false;
        }
        return std::ranges::all_of(mesh_.vertices(), [&](const auto vertex) {
            return mesh_.is_isolated(vertex) || mesh_.is_manifold(vertex);
        });
    }

    Kernel mesh_;
};

/// Of any polygons: facets' edges matched by their ends.
class MatchedEdges final : public Connectivity::Structure {
public:
    explicit MatchedEdges(const PolygonSoup& polygons)
        : polygons_(polygons), facet_of_(polygons.corners.size()), begins_(polygons.vertices.size() + 1, 0),
          corners_(polygons.corners.size()) {
        for (const std::uint32_t vertex : polygons.corners)
            ++begins_[vertex + 1];
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
        std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
        for (std::uint32_t facet = 0; facet < polygons.facets(); ++facet)
            for (std::uint32_t corner = polygons.begins[facet]; corner < polygons.begins[facet + 1]; ++corner) {
                facet_of_[corner] = facet;
                corners_[next[vertex(corner)]++] = corner;
            }
    }

    ConnectivityCounts counts() const override {
        ConnectivityCounts found;
        DisjointSets fans(polygons_.corners.size()); // corners of a vertex, joined across edges
        DisjointSets pieces(polygons_.facets());
        std::vector<std::uint32_t> border;
        // An edge is numbered by the corner where a facet's side along it begins.
        const auto ends = [&](std::size_t begin) {
            const auto corner = static_cast<std::uint32_t>(begin);
            return std::pair(vertex(corner), vertex(after(corner)));
        };
        for_each_bundle(polygons_.vertices.size(), polygons_.corners.size(), ends, [&](const auto& sides) {
            const std::uint32_t first = sides[0], end = after(first);
            if (vertex(first) == vertex(end)) {
                for (const std::uint32_t side : sides)
                    fans.join(side, after(side));
                return;
            }
            found.non_manifold_edges += sides.size() > 2;
            found.odd_edges += sides.size() % 2;
            found.misoriented_edges += sides.size() == 2 && vertex(first) == vertex(sides[1]);
            if (sides.size() == 1)
                border.push_back(first);
            for (const std::uint32_t side : sides.subspan(1)) {
                const bool same = vertex(side) == vertex(first);
                fans.join(first, same ? side : after(side));
                fans.join(end, same ? after(side) : side);
                pieces.join(facet_of_[first], facet_of_[side]);
            }
        });
        found.components = pieces.count();
        found.boundary_edges = border.size();
        found.non_manifold_vertices = count_shared_vertices(fans);
        // Boundary edges that end in the same fan belong to the same loop.
        DisjointSets loops(polygons_.corners.size());
        for (const std::uint32_t side : border)
            loops.join(fans.find(side), fans.find(after(side)));
        std::vector<std::uint32_t> names;
        for (const std::uint32_t side : border)
            names.push_back(loops.find(fans.find(side)));
        std::ranges::sort(names);
        found.holes = static_cast<std::size_t>(std::unique(names.begin(), names.end()) - names.begin());
        return found;
    }

    void fan(std::uint32_t at, std::vector<FacetCorner>& corners) const override {
        corners.clear();
        for (std::uint32_t i = begins_[at]; i < begins_[at + 1]; ++i) {
            const std::uint32_t corner = corners_[i], facet = facet_of_[corner];
            const std::uint32_t first = polygons_.begins[facet], last = polygons_.begins[facet + 1] - 1;
            corners.push_back({facet, vertex(corner == first ? last : corner - 1), at, vertex(after(corner))});
        }
    }

private:
    std::uint32_t vertex(std::uint32_t corner) const { return polygons_.corners[corner]; }

    std::uint32_t after(std::uint32_t corner) const {
        const std::uint32_t facet = facet_of_[corner];
        return corner + 1 == polygons_.begins[facet + 1] ? polygons_.begins[facet] : corner + 1;
    }

    std::size_t count_shared_vertices(DisjointSets& fans) const {
        std::size_t shared = 0;
        std::vector<std::uint32_t> fans_at(polygons_.vertices.size(), 0);
        for (std::uint32_t corner = 0; corner < polygons_.corners.size(); ++corner)
            shared += fans.find(corner) == corner && ++fans_at[vertex(corner)] == 2;
        return shared;
    }

    const PolygonSoup& polygons_;
    std::vector<std::uint32_t> facet_of_;         // of each corner
    std::vector<std::uint32_t> begins_, corners_; // of each vertex, its corners
};

} // namespace

Connectivity::Connectivity(const PolygonSoup& polygons, Method method) : polygons_(polygons) {
    if (method == Method::half_edges_if_manifold)
        structure_ = HalfEdges::build(polygons);
    has_half_edges_ = structure_ != nullptr;
    if (!has_half_edges_)
        structure_ = std::make_shared<MatchedEdges>(polygons);
}

} // namespace forceshade
