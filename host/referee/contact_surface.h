// A mesh as the referee of contacts sees it: what a straight line meets, what faces a place, on which side a place is.
// In double, in the mesh's frame. Shares no code with god-objects; only the tree, its search and the winding number.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <glm/vec3.hpp>

#include "host/field/prepared_case.h"
#include "host/mesh/structure.h"
#include "host/output/rows.h"
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

// The contacts of paths on a mesh judged from their rows alone: probes and proxies of this sample and of the last one,
// the mesh, independently of how engine and oracle move a god-object; so it detects a proxy that both of them lose.

struct ContactCount {
    bool mesh = false;            /* else no sample is checked */
    bool closed = false;          /* a mesh without rims: has sides */
    std::uint64_t samples = 0;    /* checked: all, but of probes that left their bound */
    std::uint64_t windings = 0;   /* of them, those for which a winding number was computed */
    std::uint64_t brute = 0;      /* of them, those for which loops over all triangles computed it, too */
    std::uint64_t near = 0;       /* of them, those about which rounding, skin or a narrow corner leave a doubt */
    std::uint64_t grew = 0;       /* the proxy is further from the probe than the last one would be */
    std::uint64_t unbalanced = 0; /* the force is not along the normals of the facets at the proxy */
    std::uint64_t dropped = 0;    /* no contact, and the probe is on another side than its path */
    std::uint64_t phantoms = 0;   /* contact, and nothing stands between proxy and probe */
    std::uint64_t other = 0;      /* contact, and the proxy is on another side than its path */
    std::string first;            /* where and what, for the first that is wrong */

    std::uint64_t wrong() const { return grew + unbalanced + dropped + phantoms + other; }
    void add(const ContactCount& more);
};

/// L6, of every sample, in double in the mesh's frame, with vertices as T has them:
/// - an update never takes the proxy further from the probe;
/// - in contact, probe - proxy is in the cone of the inward normals of the facets at the proxy;
/// - a proxy that sees the probe, past all facets, is at the probe;
/// - a proxy crosses no facet, so on a closed mesh the winding number is the same wherever a path has it: 0 outside, 1
///   inside, 2 where two solids overlap or a shell is within another that faces the same way. Between a cavity and the
///   outside it does not change. A path that begins behind the surface goes on in front of it.
///
/// A proxy keeps a skin off every facet, and rounding of probe, vertices and touch adds to that; in a corner narrower
/// than a right angle it is kept as many skins off as one over the sine of half the angle. What these explain is near,
/// not wrong. A proxy out of contact is the probe. A proxy in contact is written on the surface, where the side is
/// not defined; but it pulls the probe to its own side, so that a place 8 tolerances from it along the force's line is
/// on that side, unless facets around face both ways or another one lies within 64 tolerances on that line; where
/// facets cross, unless the sector between them that the force holds the proxy in is where the path is. A path that
/// begins on the surface is on the side of its first place that is certain: free, or on facets square to its force. The
/// winding number is not computed anew where a straight line from the last place for which it is known certainly meets
/// no facet.
template <typename T> class ContactReferee {
public:
    /// The case must outlive this. `samples`: of all its paths. `closed_loop`: probes that stand still have left.
    ContactReferee(const PreparedCase& prepared, std::uint64_t samples, bool closed_loop);
    ~ContactReferee();

    /// Rows in order, with positions, proxies and facets.
    void check(const PathRows<T>& rows);

    const ContactCount& count() const { return count_; }

private:
    struct Surface;
    struct Path;
    struct Sample;
    class Judge;

    std::unique_ptr<const Surface> surface_; // null unless a mesh
    bool closed_loop_;
    std::vector<Path> paths_; // of the present batch
    ContactCount count_;
};

extern template class ContactReferee<float>;
extern template class ContactReferee<double>;

} // namespace forceshade
