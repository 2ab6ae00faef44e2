// A mesh made ready for the laws: its own frame, the tree over its triangles, and the data that decide inside or
// outside.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <vector>

#include "host/mesh/mesh.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Data without coordinates; shared by all precisions.
struct MeshParts {
    std::vector<layout::MeshNode> nodes;
    std::vector<layout::MeshSlabs> slabs;
    std::vector<layout::uint> triangle_corners, triangle_facets, triangle_neighbours;
    std::vector<layout::uint> facet_begins, facet_corners;
};

/// Coordinates in the mesh's frame, and unit vectors; three numbers each.
template <typename T> struct MeshReals {
    std::vector<T> vertices, vertex_normals, vertex_pseudonormals;
    std::vector<T> triangle_normals, facet_normals, edge_pseudonormals;
};

/// For the winding number.
struct MeshWinding {
    std::vector<layout::MeshMoment> moments; /* 1 a node */
    std::vector<layout::uint> rims;          /* 3 an edge where the surface ends */
};

/// The triangles that a god-object may meet that slides over the front of a triangle; a list a triangle.
struct MeshObstacles {
    std::vector<layout::uint> begins;    /* triangles + 1 */
    std::vector<layout::uint> triangles; /* or kMeshAnyObstacle alone */
};

/// The mesh in its own frame: (world - centre) / scale, centre the middle of the bounding box, scale the least power of
/// two that leaves no coordinate beyond 1. Triangles are those of make_surface, in the tree's order; vertices are
/// numbered by first use, facets as in the file.
///
/// Bytes a triangle, for a closed mesh of T triangles in double (T/2 vertices, T facets): nodes 34 (192 each, between 5
/// and 6 triangles below), corners 12, facets 4, neighbours 12, vertices 12, their normals 12 and pseudonormals 12,
/// triangle normals 24, facets' corners 16 and normals 24: 162; the winding number's moments 33 more; lists of
/// obstacles 4 where the surface is convex, 29 on a scanned bunny.
struct MeshStructure {
    glm::dvec3 centre; /* m, world */
    double scale;      /* m */
    std::shared_ptr<const MeshParts> parts;
    std::shared_ptr<const MeshReals<double>> reals;
    std::shared_ptr<const MeshWinding> winding; /* null unless asked for */
    bool solid = false;                         /* see assume_solid */
    std::shared_ptr<const Clearance> clearance; /* of a solid, and where the triangles are all of the mesh's */

    std::size_t triangles() const { return parts->triangle_facets.size(); }
    std::size_t bytes() const;
};

/// Options of build_structure. The result does not depend on the threads.
struct StructureOptions {
    unsigned threads = 0;        /* 0: most_threads() */
    bool winding = false;        /* also the tables of the winding number */
    unsigned leaf_triangles = 4; /* most triangles of a leaf, 1 to layout::kMeshLeafTriangles */
};

/// Throws UsageError for a mesh without any triangle that has an area, with 2^28 triangles or more, or whose
/// coordinates no double can hold the differences of.
MeshStructure build_structure(const Mesh& mesh, const StructureOptions& options = {});

/// Of a mesh that is known to be closed, of one piece, consistently oriented and nowhere to meet itself: no side
/// changes where there is no surface, which `solid` then says. Not where a pseudonormal is so short that rounding could
/// turn it.
void assume_solid(MeshStructure& structure);

/// The winding number just behind the facets: the median over 256 of them. 1 for closed surfaces that face outward, 1/2
/// for sheets. Of a structure with `winding`.
double winding_behind(const MeshStructure& structure);

/// A structure in T for one stiffness; what a scene evaluates, at places from origin_of(). Of double it shares
/// everything with the structure.
template <typename T> struct MeshTables {
    layout::MeshParams<T> params;
    std::shared_ptr<const MeshParts> parts;
    std::shared_ptr<const MeshReals<T>> reals;
    std::shared_ptr<const MeshWinding> winding;
    bool solid;
    std::shared_ptr<const Clearance> clearance;     /* as in the structure */
    std::shared_ptr<const MeshObstacles> obstacles; /* null unless asked for */

    /// Valid as long as any copy of these tables.
    layout::MeshView<T> view() const;
};

/// Throws UsageError if the frame's scale, or the force at 1 of it (`stiffness` in N/m times the scale), is no normal
/// number of T; a stiffness of 0 is allowed.
template <typename T> MeshTables<T> make_mesh_tables(const MeshStructure& structure, double stiffness);

/// Fills tables.obstacles, which only makes god-objects faster.
template <typename T> void find_obstacles(MeshTables<T>& tables, unsigned threads = 0);

/// The scene's origin, m: the place from which places are measured before they are rounded to T, so that the
/// forces are the same wherever the mesh lies. On each axis 0 for a mesh whose centre is within 4 scales of 0; else the
/// multiple of the scale nearest to the centre.
glm::dvec3 origin_of(const MeshStructure& structure);

/// A place of the world, m, in the mesh's frame; in double, to be rounded once.
inline glm::dvec3 to_mesh_frame(const MeshStructure& structure, const glm::dvec3& world) {
    return (world - structure.centre) / structure.scale;
}

/// m: z of the highest place of the mesh above or below (x, y), m; empty elsewhere.
std::optional<double> height_at(const MeshStructure& structure, double x, double y);

/// Whether straight in front of or behind the middle of some triangle another one stands within `reach`, in units of
/// the mesh's frame: a thin wall, a sharp wedge, or a narrow gap. Looks at 2^16 triangles at most, evenly chosen.
bool has_thin_parts(const MeshStructure& structure, double reach);

/// For the generalized winding number: the moments of each node's triangles and the edges where the surface ends.
std::shared_ptr<const MeshWinding> make_winding(const MeshStructure& structure);

// Of build_structure: the tree over its triangles.

/// The box of a triangle, rounded outwards to single precision.
struct TreeItem {
    std::array<float, 3> low;
    std::uint32_t triangle;
    std::array<float, 3> high;
    std::uint32_t unused;
};

/// Of a triangle none of whose coordinates is beyond 1.
TreeItem tree_item(std::uint32_t triangle, const std::array<glm::dvec3, 3>& corners);

/// Brings the items into the tree's order and returns its nodes, root first; leaves are runs of items. No path from the
/// root has more than reference::kMeshTreeDepth nodes, whatever the items. The same for any number of threads.
std::vector<layout::MeshNode> build_tree(std::vector<TreeItem>& items, unsigned leaf_triangles, unsigned threads);

/// Fills parts.slabs.
void bound_by_slabs(MeshParts& parts, const MeshReals<double>& reals, unsigned threads);

} // namespace forceshade
