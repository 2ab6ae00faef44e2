// How the facets of a polygon mesh are connected, and which of them belong together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
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

// The pieces of a mesh, which side of each is out, and how they are turned so that they face outward.

/// Facets that are connected across edges of two facets.
struct MeshPiece {
    std::uint32_t first_facet = 0; // the lowest
    std::size_t facets = 0;
    bool closed = true;      // each of its edges has an even number of its facets
    bool one_sided = false;  // no way of turning its facets makes them agree, as on a Moebius strip
    std::size_t opposed = 0; // facets that disagree with those that make up most of its area
    double volume = 0;       // of a closed piece, in the polygons' unit; negative where it faces inward
    double surrounding = 0;  // of a closed piece whose facets agree: the winding number of the others there
    bool is_inside_out() const { return closed && opposed == 0 && volume < 0 && surrounding < 0.75; }
    bool is_nested() const { return closed && opposed == 0 && volume > 0 && surrounding > 0.75; }
};

struct MeshPieces {
    std::vector<MeshPiece> pieces;       // by their lowest facet
    std::vector<std::uint32_t> of_facet; // its piece
    std::vector<bool> opposed;           // of each facet, see MeshPiece
};

/// Of polygons whose vertices at one place are joined. A piece that faces inward with another around it is a cavity;
/// the winding number is looked for as long as that takes no more than some 10^8 triangles.
MeshPieces find_pieces(const PolygonSoup& polygons);

/// "piece 2 of 3 (12 facets, from facet 40 on)"; "the mesh" if it is the only piece.
std::string name_of(std::size_t piece, const MeshPieces& found);

/// Turns facets so that those of a piece agree, with most of its area; then closed pieces that are inside out, and with
/// them the pieces that face outward within, which were their cavities. Other cavities stay. Corners' normals stay with
/// their corners.
/// \returns a sentence for each piece that was turned, or some facets of which were
/// \throws UsageError for a piece with one side only
std::vector<std::string> orient_outward(PolygonSoup& polygons);

// Facets with the same corners, by place, and which of them count.

/// Facets coincide if they have the same places in the same or the opposite cyclic order.
/// - The same order: a repeat of the first one in the file.
/// - The opposite order, both with an area: of such a pair one is a stray if without it the edges match better. That
///   is, along more than half of the pair's edges the facets of the mesh run more often in its direction than in the
///   other, and along none less often. Strays that share edges with strays are found out one from the other.
/// - Else a pair is a sheet of two sides, or a wall within a solid: matching edges does not distinguish the
///   sides.
struct CoincidentFacets {
    std::vector<std::uint32_t> redundant; /* ascending: repeats and strays, which are ignored */
    std::size_t opposed = 0;              /* pairs of which both count */
};

/// \param facet_normals 0 where a facet has no area
CoincidentFacets find_coincident(const PolygonSoup& polygons, std::span<const glm::dvec3> facet_normals);

/// The same vertices, and the facets that are not in `left_out` (ascending).
PolygonSoup without_facets(const PolygonSoup& polygons, std::span<const std::uint32_t> left_out);

} // namespace forceshade
