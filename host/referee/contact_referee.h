// The contacts of paths on a mesh judged from their rows alone: probes and proxies of this sample and of the last one,
// the mesh, independently of how engine and oracle move a god-object; so it detects a proxy that both of them lose.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/output/rows.h"

namespace forceshade {

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
