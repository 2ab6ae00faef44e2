// The error of an evaluated field against the oracle in double precision, gathered while its chunks pass by.
#pragma once

#include <cstdint>

#include "host/field/prepared_case.h"
#include "host/validate/mesh_bound.h"
#include "host/validate/rounding_bound.h"
#include "shaders/shared/layout.h"

namespace forceshade {

struct OracleError {
    std::uint64_t compared = 0;  /* voxels */
    std::uint64_t differing = 0; /* voxels whose bits are not the oracle's in the same precision */
    std::uint64_t beyond = 0;    /* of them, those further from it than rounding allows: on a software device all */
    std::uint64_t on_edge = 0;   /* voxels of a mesh as near to another facet, or to the surface, as rounding reaches:
                                    their error says nothing and is not counted */
    double largest = 0;          /* N: largest |F - F_oracle|, the oracle in double */
    double largest_force = 0;    /* N: largest |F_oracle| among the voxels compared */

    /// The largest error over the largest force; 0 for a field without force.
    double relative() const { return largest_force > 0 ? largest / largest_force : 0; }
};

/// Compares evenly chosen rows, all of them where the grid is small, so that the cost is bounded.
class OracleCheck {
public:
    /// Of what varies in a case, which must outlive this; `exact_bits`: the engine must equal the oracle bit for bit.
    OracleCheck(const PreparedCase& prepared, bool exact_bits);

    void add(const layout::FieldChunk<float>& chunk);
    void add(const layout::FieldChunk<double>& chunk);
    const OracleError& error() const { return error_; }

private:
    template <typename T> void compare(const layout::FieldChunk<T>& chunk, const FieldTables<T>& same);
    bool is_beyond(const Triple& force, double off, const Triple& probe);
    MeshBound& mesh_bound();

    const PreparedCase& prepared_;
    bool exact_bits_;

    FieldTables<double> exact_;
    std::optional<FieldTables<float>> single_; // the oracle in single precision, where the run is
    std::optional<RoundingBound> bound_;       // made when first asked for
    std::optional<MeshBound> mesh_bound_;      // likewise
    std::uint64_t every_;                      // rows: one in so many is compared
    OracleError error_;
};

} // namespace forceshade
