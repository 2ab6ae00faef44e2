#include "host/mesh/connectivity.h"

#include <algorithm>
#include <numeric>
#include <set>

#include <OpenMesh/Core/Geometry/VectorT.hh>
#include <OpenMesh/Core/Mesh/PolyMesh_ArrayKernelT.hh>
#include <OpenMesh/Core/System/omstream.hh>

#include "host/mesh/places.h"

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
        : polygons_(polygons), sides_(polygons), begins_(polygons.vertices.size() + 1, 0),
          corners_(polygons.corners.size()) {
        for (const std::uint32_t vertex : polygons.corners)
            ++begins_[vertex + 1];
        std::partial_sum(begins_.begin(), begins_.end(), begins_.begin());
        std::vector<std::uint32_t> next(begins_.begin(), begins_.end() - 1);
        for (std::uint32_t corner = 0; corner < corners_.size(); ++corner)
            corners_[next[polygons.corners[corner]]++] = corner;
    }

    ConnectivityCounts counts() const override {
        ConnectivityCounts found;
        DisjointSets fans(polygons_.corners.size()); // corners of a vertex, joined across edges
        DisjointSets pieces(polygons_.facets());
        std::vector<std::uint32_t> border;
        sides_.for_each_edge([&](std::span<const std::uint32_t> sides) {
            const std::uint32_t first = sides[0], end = sides_.after(first);
            if (sides_.start(first) == sides_.start(end)) {
                for (const std::uint32_t side : sides)
                    fans.join(side, sides_.after(side));
                return;
            }
            found.non_manifold_edges += sides.size() > 2;
            found.odd_edges += sides.size() % 2;
            found.misoriented_edges += sides.size() == 2 && sides_.start(first) == sides_.start(sides[1]);
            if (sides.size() == 1)
                border.push_back(first);
            for (const std::uint32_t side : sides.subspan(1)) {
                const bool same = sides_.start(side) == sides_.start(first);
                fans.join(first, same ? side : sides_.after(side));
                fans.join(end, same ? sides_.after(side) : side);
                pieces.join(sides_.facet(first), sides_.facet(side));
            }
        });
        found.components = pieces.count();
        found.boundary_edges = border.size();
        found.non_manifold_vertices = count_shared_vertices(fans);
        // Boundary edges that end in the same fan belong to the same loop.
        DisjointSets loops(polygons_.corners.size());
        for (const std::uint32_t side : border)
            loops.join(fans.find(side), fans.find(sides_.after(side)));
        std::set<std::uint32_t> names;
        for (const std::uint32_t side : border)
            names.insert(loops.find(fans.find(side)));
        found.holes = names.size();
        return found;
    }

    void fan(std::uint32_t at, std::vector<FacetCorner>& corners) const override {
        corners.clear();
        for (std::uint32_t i = begins_[at]; i < begins_[at + 1]; ++i) {
            const std::uint32_t corner = corners_[i], facet = sides_.facet(corner);
            const std::uint32_t first = polygons_.begins[facet], last = polygons_.begins[facet + 1] - 1;
            corners.push_back({facet, sides_.start(corner == first ? last : corner - 1), at, sides_.end(corner)});
        }
    }

private:
    std::size_t count_shared_vertices(DisjointSets& fans) const {
        std::size_t shared = 0;
        std::vector<std::uint32_t> fans_at(polygons_.vertices.size(), 0);
        for (std::uint32_t corner = 0; corner < polygons_.corners.size(); ++corner)
            shared += fans.find(corner) == corner && ++fans_at[polygons_.corners[corner]] == 2;
        return shared;
    }

    const PolygonSoup& polygons_;
    FacetSides sides_;
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
