// The pieces of a mesh, which side of each is out, and how they are turned so that they face outward.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "host/mesh/mesh.h"

namespace forceshade {

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

} // namespace forceshade
