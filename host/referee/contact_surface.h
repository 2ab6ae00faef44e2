// A mesh as the referee of contacts sees it: what a straight line meets, what faces a place, on which side a place is.
// In double, in the mesh's frame. Shares no code with god-objects; only the tree, its search and the winding number.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "host/mesh/structure.h"
#include "host/referee/referee.h"
#include "shaders/shared/law.h"

namespace forceshade {

enum class Meets { no, unsure, yes };

/// The sign of the volume (a - d) . ((b - d) x (c - d)); 0 where the rounding of long double could turn it.
int volume_sign(const glm::dvec3& a, const glm::dvec3& b, const glm::dvec3& c, const glm::dvec3& d);

/// Whether the segment and the triangle have a point in common: certain, or unsure.
Meets segment_meets(const glm::dvec3& from, const glm::dvec3& to, const std::array<glm::dvec3, 3>& triangle);

class ContactSurface {
public:
    /// `vertices`: those of the structure, rounded as an engine has them. The mesh must outlive this.
    ContactSurface(const Mesh& mesh, MeshStructure structure, std::vector<double> vertices);

    bool closed() const { return law_.mesh.rims.empty(); }
    double scale() const { return structure_.scale; }
    /// What places are measured from, m, in the world: the scene's origin.
    const glm::dvec3& origin() const { return origin_; }
    /// A place from the scene's origin, m, in the frame.
    glm::dvec3 to_frame(const glm::dvec3& place) const {
        return (place - (structure_.centre - origin_)) / structure_.scale;
    }
    glm::dvec3 to_world(const glm::dvec3& local) const { return structure_.centre + structure_.scale * local; }

    /// Whether a straight line meets a facet.
    Meets meets(const glm::dvec3& from, const glm::dvec3& to) const;
    /// Whether it meets none, nor one that is `aside` of it.
    bool is_clear(const glm::dvec3& from, const glm::dvec3& to, double aside) const;

    double distance(const glm::dvec3& place) const;
    /// The winding number; none nearer to the surface than `nearest`, or if it is not whole.
    std::optional<int> side_by_tree(const glm::dvec3& place, double nearest) const;
    std::optional<int> side_by_loops(const glm::dvec3& place, double nearest) const;
    /// The winding number where a path begins: at its probe, or if that is behind the surface, beyond the nearest
    /// place; none if one of these is nearer to the surface than `nearest`.
    std::optional<int> side_of_start(const glm::dvec3& probe, double nearest, bool by_winding) const;
    /// 1 where a path with this winding number is in front of all facets, -1 where it is behind; 0: not known.
    int facing(std::optional<int> side) const;

    /// Whether facets around a place face both ways along a direction, by more than one part in 8.
    bool face_both_ways(const glm::dvec3& place, const glm::dvec3& towards, double reach) const;

    /// Those of the triangles at a place that meet another of them there without a common corner.
    std::vector<std::uint32_t> crossing(std::span<const std::uint32_t> triangles) const;

    /// The triangle of a facet whose face holds a place, further than `margin` from its edges and no further off it.
    std::optional<std::uint32_t> face_at(std::uint32_t facet, const glm::dvec3& place, double margin) const;
    glm::dvec3 normal(std::uint32_t triangle) const;

    /// The triangles within reach of a place whose planes are within `margin` of it.
    std::vector<std::uint32_t> triangles_at(const glm::dvec3& place, double reach, double margin) const;
    /// How far a force's direction is from the inward normals of triangles, which their front (1) or back (-1) faces,
    /// or both (0). `convex`: those count together as well that the proxy slides over from one to the other.
    double residual(const glm::dvec3& pull, std::span<const std::uint32_t> triangles, int facing, bool convex,
                    double margin) const;
    /// How far from these triangles' planes' meeting a proxy is kept that is `skin` off each of them.
    double kept_off(std::span<const std::uint32_t> triangles, int facing, double skin, double margin) const;

private:
    std::array<glm::dvec3, 3> corners(std::uint32_t triangle) const;
    bool is_convex(std::uint32_t one, std::uint32_t other, int facing, double margin) const;
    bool share_a_corner(std::uint32_t one, std::uint32_t other) const;

    const Mesh& mesh_;
    MeshStructure structure_;
    glm::dvec3 origin_; /* m */
    MeshTables<double> tables_;
    std::vector<double> vertices_;
    layout::Law<double> law_{};
    brute::MeshReferee referee_;
    std::vector<std::uint32_t> facet_begins_, facet_triangles_;
    std::optional<int> front_; // the winding number in front of a solid's facets
};

// Cones of normals: how far a force is from one, how far planes keep a proxy off a corner.

/// How far a vector is from the cone that unit vectors span; `together(i, j)`: two of them may be combined. The
/// nearest place of a cone is in the span of no more than three of its vectors, with no negative share of any: all are
/// tried, in cubic time.
double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans,
                          const std::function<bool(std::size_t, std::size_t)>& together);

/// The same where all may be combined, in time linear in their number (active set; Lawson & Hanson 1974, chapter 23).
double distance_from_cone(const glm::dvec3& vector, std::span<const glm::dvec3> spans);

/// How far from the origin a place is at least that is 1 in front of each of the planes through the origin with these
/// unit normals (Lawson & Hanson 1974, LDP); infinite if there is none.
double distance_of_offset_planes(std::span<const glm::dvec3> normals);

} // namespace forceshade
