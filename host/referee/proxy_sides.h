// On which side of a closed mesh the proxies of paths are, told by the winding number: neither engine nor oracle asks
// it once a path has begun, so it sees a proxy that both of them lose.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "host/output/rows.h"
#include "host/prepare/prepared_case.h"
#include "host/referee/mesh_referee.h"

namespace forceshade {

struct SideCount {
    bool closed = false;       /* a mesh without rims: else nothing is looked at */
    std::uint64_t samples = 0; /* looked at: of each path the first, the last, and evenly chosen ones */
    std::uint64_t brute = 0;   /* of them, those whose side loops over all triangles told, too */
    std::uint64_t near = 0;    /* of them, those too near to the surface, or in too narrow a corner, to tell */
    std::uint64_t other = 0;   /* of them, those whose proxy is on another side than that of the path's beginning */
    std::string first;         /* where and what, for the first of these */
};

/// A proxy crosses no facet, so the winding number is the same wherever a path has it: 0 outside, 1 inside, 2 where two
/// solids overlap or a shell is within another that faces the same way. Between a cavity and the outside it does not
/// tell. A path that begins behind the surface goes on in front of it.
///
/// A proxy out of contact is the probe. It keeps a skin off every facet, so it is at the probe only where that is as
/// far off; what rounds probe, vertices and touch adds to the skin. Beyond twice the skin and that, in units of the
/// frame, its side is certain. A proxy in contact is written on the surface, where no side can be told; but it pulls
/// the probe to its own side, so that a place 8 times as far from it along the force's line is on that side, unless
/// facets around face both ways: in a corner narrower than a right angle the line may lead through the other wall.
template <typename T> class ProxySides {
public:
    /// The case must outlive this. `samples`: of all its paths. `closed_loop`: probes that stand still have left.
    ProxySides(const PreparedCase& prepared, std::uint64_t samples, bool closed_loop);
    ~ProxySides();

    /// Rows in order, with positions, proxies and facets.
    void check(const PathRows<T>& rows);

    const SideCount& count() const { return count_; }

private:
    struct Surface;
    struct Path;
    struct Sample;
    void check_sample(const Sample& sample, Path& path);
    void begin(const Sample& sample, Path& path);

    std::unique_ptr<const Surface> surface_; // null unless a closed mesh
    std::uint64_t every_, brute_every_ = 1;  // samples looked at; of them, those that loops look at
    std::uint64_t affordable_ = 0;           // samples that loops may look at
    bool closed_loop_;
    std::vector<Path> paths_; // of the present batch
    SideCount count_;
};

extern template class ProxySides<float>;
extern template class ProxySides<double>;

} // namespace forceshade
