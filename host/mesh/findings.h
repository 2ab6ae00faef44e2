// Inspection of a mesh before a law is computed on it: counts, size, faults, where it meets itself, and what a picture
// marks.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "host/mesh/connectivity.h"

namespace forceshade {

struct MeshStructure;

/// Lengths, areas and volumes are in the unit of the polygons' coordinates. Vertices that no facet uses count as unused
/// and nowhere else; redundant facets enter only the counts of facets.
struct MeshFindings : ConnectivityCounts {
    std::size_t vertices = 0, unused_vertices = 0;
    std::size_t facets = 0, triangles = 0, quadrilaterals = 0, others = 0;
    std::size_t most_corners = 0;                  // of a facet
    std::size_t degenerate_facets = 0;             // without area
    std::size_t redundant_facets = 0;              // that coincide with others and are ignored
    std::size_t opposed_facets = 0;                // pairs that coincide, of opposite orientation, of which both count
    std::size_t repeated_corner_facets = 0;        // that have a vertex twice
    std::size_t joined_vertices = 0;               // given again at the place of an earlier one, or near it
    std::size_t vanished_facets = 0;               // by joining vertices that are near each other
    std::vector<std::string> inside_out;           // names of closed pieces that face inward with no other around them
    std::vector<std::string> nested;               // names of closed pieces that face outward within another
    std::vector<std::string> one_sided;            // names of pieces without an outside
    std::optional<double> closing_distance;        // see places.h
    std::optional<std::size_t> self_intersections; // pairs of triangles without a common corner that touch or cross
    bool more_self_intersections = false;          // the search was given up after those
    bool closed = false;                           // every edge has two facets, or another even number
    double area = 0, volume = 0;                   // volume: positive where facets are oriented outward
    glm::dvec3 low{0}, high{0};                    // corners of the bounding box
};

/// Most triangles among which self-intersections are looked for.
inline constexpr std::size_t kSelfIntersectionTriangles = 4'000'000;

/// Looks at everything. Corners must be in range and coordinates finite.
MeshFindings inspect(const PolygonSoup& polygons, std::size_t self_intersection_triangles = kSelfIntersectionTriangles);

// The same in steps, so that the first can run while another thread finds out how the facets are connected.

struct ShapeFindings {
    MeshFindings findings;                /* without self-intersections, counts of connections, and `closed` */
    std::vector<std::uint32_t> redundant; /* facets, ascending */
};
ShapeFindings inspect_shape(const PolygonSoup& polygons);
/// Fills findings.self_intersections, unless there are more triangles than are looked at.
void find_self_intersections(const PolygonSoup& polygons, ShapeFindings& shape,
                             std::size_t most_triangles = kSelfIntersectionTriangles);
MeshFindings with_connections(ShapeFindings shape, const Connectivity& mesh);

/// True if it is known that the facets bound one solid whose surface nowhere meets itself.
bool is_solid(const MeshFindings& findings);

/// The use for which a mesh is inspected.
enum class MeshUse {
    pseudonormal_field, // static, inside by pseudonormals
    winding_field,      // static, inside by the winding number
    path,               // the god-object, which meets every facet and needs no inside
};

/// A fault of a mesh or a remark on it, in words.
struct MeshFault {
    std::string what;        // with its count
    std::string force = "";  // its effect on the force; may be empty
    std::string remedy = ""; // what helps; may be empty
    std::string key = "";    // of [surface], in TOML, where one helps: orient = "outward"
    bool is_wrong = true;
};

/// Empty if nothing is wrong.
/// \param unit of lengths in the text, in which one of the polygons' unit is `metres`
std::vector<MeshFault> faults(const MeshFindings& findings, MeshUse use = MeshUse::pseudonormal_field,
                              const std::string& unit = "of the file's unit", double metres = 1);

/// "WHAT: FORCE; REMEDY".
std::string sentence(const MeshFault& fault);

/// \throws UsageError naming `mesh` if no law has a meaning on it: no facet, none with an area, or
///         coordinates whose volumes overflow
void refuse_if_meaningless(const MeshFindings& findings, const std::string& mesh);

/// Pairs of triangles that touch or cross without having a corner in common.
struct SelfIntersections {
    std::size_t pairs = 0;
    std::vector<std::uint32_t> triangles; // of these pairs, ascending
    bool complete = true; // false: given up after `most_pairs`, or because far too many pairs came near each other
};

/// With exact predicates, over the pairs whose bounding boxes overlap. Corners at the same place (`places`: of each
/// vertex, from weld()) are the same corner; triangles without area are passed over. The result does not depend on
/// the threads (0: most_threads()).
SelfIntersections count_self_intersections(const PolygonSoup& polygons, std::span<const std::uint32_t> places,
                                           const MeshTriangles& triangles, std::size_t most_pairs,
                                           unsigned threads = 0);

/// The places that a picture of a mesh marks.
struct MeshMarks {
    using Edge = std::array<glm::dvec3, 2>; /* m */

    std::vector<Edge> rims;              // of one facet
    std::vector<Edge> crowded;           // of more than two
    std::vector<Edge> sharp;             // of two whose normals differ by more than kSharp
    std::vector<bool> inward;            // of each facet: it disagrees with its piece, or its piece is inside out
    std::vector<std::uint32_t> crossing; // triangles of Mesh, ascending, that touch or cross others

    static constexpr double kSharp = 60; /* deg */
};

/// \param structure of the mesh
MeshMarks find_marks(const Mesh& mesh, const MeshStructure& structure, const MeshFindings& findings);

} // namespace forceshade
