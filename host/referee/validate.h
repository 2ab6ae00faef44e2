// An engine compared with the oracle in the same precision, the oracle in double, and the closed forms (of a mesh a
// loop over all triangles), on every voxel of a case.
#pragma once

#include <string>
#include <vector>

#include "host/field/engine.h"
#include "host/field/prepared_case.h"
#include "host/scene/scene.h"

namespace forceshade {

/// The scene with its edges and radii rounded to T as a kernel's tables round them, so that a referee of the rounded
/// scene puts a voxel of rounded position on the same side of every edge as a kernel without error does. A voxel
/// exactly on an edge in T has a force that need not occur anywhere in the scene as written: two edges that coincide,
/// one closed and one open, or a half-open facet next to an open cylinder.
template <typename T> Scene rounded_scene(const Scene& scene);

extern template Scene rounded_scene<float>(const Scene&);
extern template Scene rounded_scene<double>(const Scene&);

/// Of comparisons of any kind.
struct Totals {
    std::uint64_t compared = 0, differing = 0; /* voxels, or samples of paths */
    bool passed = true;
};

template <typename One> Totals totals_of(const std::vector<One>& comparisons) {
    Totals all;
    for (const One& one : comparisons) {
        const Totals own = one.totals();
        all = {all.compared + own.compared, all.differing + own.differing, all.passed && own.passed};
    }
    return all;
}

/// How far a field is from one referee.
struct Distance {
    double largest = 0;            /* N: largest |F - F_referee| of all others */
    std::uint64_t boundary = 0;    /* voxels with a channel beyond the bound, but equal to the referee a few ULP away:
                                      they fell to the other side of an edge, and their error is meaningless */
    std::uint64_t unexplained = 0; /* voxels beyond the bound without that excuse */
};

struct Comparison {
    std::string name;
    Precision precision = Precision::f32;
    std::uint64_t voxels = 0;
    // Against the oracle in the same precision.
    std::uint64_t differing = 0;   /* voxels any of whose channels differs in a bit */
    std::uint64_t largest_ulp = 0; /* largest distance of a force component, in units in the last place */
    std::uint64_t beyond = 0;      /* voxels any of whose channels is further off than rounding allows (no software
                                      device may differ at all) */
    std::uint64_t boundary = 0;    /* voxels that would be, but lie on an edge of that oracle */

    Distance oracle; /* from reference<double>; for a run in double that is the same oracle */
    Distance closed_form;
    double largest_force = 0; /* N, of the closed form */
    bool passed = false;
    std::string first_difference; /* where and what, for the first voxel that fails */

    double relative(const Distance& distance) const { return largest_force > 0 ? distance.largest / largest_force : 0; }
    Totals totals() const { return {voxels, differing, passed}; }
};

/// Evaluates every voxel (none is copied from another) and compares. \throws compute::DeviceError, Interrupted.
Comparison compare_case(Engine& engine, const PreparedCase& prepared, Precision precision);

/// The comparisons as a table for people.
std::string comparison_table(const std::vector<Comparison>& comparisons);

/// The same as JSON: device, cases, totals.
std::string comparison_json(const std::vector<Comparison>& comparisons, const EngineReport& engine);

} // namespace forceshade
