// How far what was evaluated lies from the oracle.
#pragma once

#include <cstdint>
#include <string>

namespace forceshade {

/// Of a field.
struct OracleError {
    std::uint64_t compared = 0;  /* voxels */
    std::uint64_t differing = 0; /* voxels whose bits are not the oracle's in the same precision */
    std::uint64_t beyond = 0;    /* of them, those further from it than rounding allows: on a software device all */
    std::uint64_t on_edge = 0; /* voxels as near to another facet of a mesh, or to its surface, as rounding reaches, or
                                  rounded to the other side of an edge: their error says nothing and is not counted */
    double largest = 0;        /* N: largest |F - F_oracle|, the oracle in double */
    double largest_force = 0;  /* N: largest |F_oracle| among the voxels compared */

    /// The largest error over the largest force; 0 for a field without force.
    double relative() const { return largest_force > 0 ? largest / largest_force : 0; }
};

/// Of paths.
struct PathError {
    std::uint64_t paths = 0;     /* compared */
    std::uint64_t samples = 0;   /* compared */
    std::uint64_t differing = 0; /* samples any of whose channels differs in a bit */
    std::uint64_t beyond = 0;    /* samples further from the oracle than rounding allows: on a software device all that
                                    differ */
    std::uint64_t metrics = 0;   /* paths whose metrics differ: on a software device in a bit, else beyond rounding */
    double largest = 0;          /* N: largest |F - F_oracle| */
    double largest_force = 0;    /* N: of the oracle */
    std::string first;           /* where and what, for the first sample or path that is beyond */

    bool passed() const { return beyond == 0 && metrics == 0; }
};

} // namespace forceshade
