// How the facets of a polygon mesh are connected.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

struct ConnectivityCounts {
    std::size_t components = 0;            // pieces whose facets are connected by edges
    std::size_t boundary_edges = 0;        // of one facet
    std::size_t holes = 0;                 // loops of boundary edges
    std::size_t non_manifold_edges = 0;    // of more than two facets
    std::size_t odd_edges = 0;             // of an odd number of facets: the surface does not close there
    std::size_t non_manifold_vertices = 0; // of more than one fan of facets
    std::size_t misoriented_edges = 0;     // of two facets that run through it in the same direction
    friend bool operator==(const ConnectivityCounts&, const ConnectivityCounts&) = default;
};

/// A facet's corner, between the vertices before and after it along the facet.
struct FacetCorner {
    std::uint32_t facet, before, vertex, after;
    friend bool operator==(const FacetCorner&, const FacetCorner&) = default;
};

/// OpenMesh's half-edge mesh. Matched edges of our own stand in for it where it cannot hold the facets: an edge of more
/// than two facets or of two that run through it in the same direction, a vertex of more than one fan (the loops that
/// OpenMesh links there are arbitrary), a facet with a corner twice, and vertices with too many edges: OpenMesh's
/// search among them would take long. Order is the file's in both.
class Connectivity {
public:
    enum class Method { half_edges_if_manifold, matched_edges };

    /// Converts implicitly, so that functions of the connectivity take polygons. The polygons must outlive it.
    Connectivity(const PolygonSoup& polygons, Method method = Method::half_edges_if_manifold);
    /// Of the same facets with their vertices elsewhere; those first polygons must outlive it as well.
    Connectivity(const PolygonSoup& polygons, const Connectivity& same)
        : polygons_(polygons), structure_(same.structure_), has_half_edges_(same.has_half_edges_) {}

    const PolygonSoup& polygons() const noexcept { return polygons_; }
    bool has_half_edges() const noexcept { return has_half_edges_; }

    struct Structure {
        virtual ~Structure() = default;
        virtual ConnectivityCounts counts() const = 0;
        /// The corners at a vertex, by facet and corner, so that sums over them have one order.
        virtual void fan(std::uint32_t vertex, std::vector<FacetCorner>& corners) const = 0;
    };
    const Structure* operator->() const noexcept { return structure_.get(); }

private:
    const PolygonSoup& polygons_;
    std::shared_ptr<const Structure> structure_;
    bool has_half_edges_;
};

} // namespace forceshade
