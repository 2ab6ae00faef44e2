// How the facets of a mesh hang together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <numeric>
#include <optional>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

struct Connectivity {
    std::size_t components = 0;            // pieces whose facets hang together by edges
    std::size_t boundary_edges = 0;        // of one facet
    std::size_t holes = 0;                 // loops of boundary edges
    std::size_t non_manifold_edges = 0;    // of more than two facets
    std::size_t odd_edges = 0;             // of an odd number of facets: the surface does not close there
    std::size_t non_manifold_vertices = 0; // of more than one fan of facets
    std::size_t misoriented_edges = 0;     // of two facets that run through it in the same direction
    friend bool operator==(const Connectivity&, const Connectivity&) = default;
};

/// By matching the facets' edges: any polygons, manifold or not.
Connectivity connectivity_by_edges(const PolygonSoup& polygons);

/// By OpenMesh's half-edge structure, which can hold a mesh only if every edge has one or two facets that run through
/// it in opposite directions. std::nullopt if it cannot, if the facets of a vertex are not one fan (then the loops that
/// it links are arbitrary), if a facet comes to a vertex twice, or if vertices have so many edges that its search would
/// take long.
std::optional<Connectivity> connectivity_by_half_edges(const PolygonSoup& polygons);

/// By half-edges where they can hold the mesh, else by edges; the same numbers.
Connectivity connectivity(const PolygonSoup& polygons);

// Things joined into sets (union-find with path halving).

class DisjointSets {
public:
    explicit DisjointSets(std::size_t count) : parents_(count) { std::iota(parents_.begin(), parents_.end(), 0u); }

    /// The set's least member.
    std::uint32_t find(std::uint32_t member) noexcept {
        while (parents_[member] != member)
            member = parents_[member] = parents_[parents_[member]];
        return member;
    }

    void join(std::uint32_t a, std::uint32_t b) noexcept {
        a = find(a);
        b = find(b);
        if (a < b)
            parents_[b] = a;
        else
            parents_[a] = b;
    }

private:
    std::vector<std::uint32_t> parents_;
};

} // namespace forceshade
