// The error of an evaluated field against the oracle in double precision, over voxels drawn while its chunks pass by.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "host/field/prepared_case.h"
#include "host/output/record.h"
#include "host/referee/rounding_bound.h"
#include "shaders/shared/law.h"

namespace forceshade {

/// Where a voxel lies, by its forces and those of its neighbours: in free space, next to the boundary of contact,
/// next to a jump of the direction (an edge, or a tie of two facets), or else inside.
enum class VoxelKind { free, boundary, jump, inside };
inline constexpr std::size_t kVoxelKinds = 4;

/// Draws as many voxels of every kind, all where there are fewer, out of as many rows as hold about two million: which
/// ones is decided by their numbers alone, so that it is the same in every run. The cost is bounded: some thousand
/// evaluations on a mesh, whose oracle is dear, some ten thousand elsewhere.
class OracleCheck {
public:
    /// Of what varies in a case, which must outlive this; `exact_bits`: the engine must equal the oracle bit for bit.
    OracleCheck(const PreparedCase& prepared, bool exact_bits);

    template <typename T> void add(const layout::FieldChunk<T>& chunk);
    /// Compares what was drawn, on `threads` threads.
    OracleError compare(unsigned threads) const;

private:
    struct Voxel {
        std::uint64_t rank; // those of the lowest ranks are kept
        std::array<std::uint32_t, 3> at;
        glm::dvec3 force; /* N */
        bool operator<(const Voxel& other) const { return rank < other.rank; }
    };

    bool draws_from(std::size_t row) const;
    void keep(VoxelKind kind, const Voxel& voxel);
    template <typename T> OracleError compare_some(std::span<const Voxel> voxels, const FieldTables<T>& same) const;

    const PreparedCase& prepared_;
    const bool exact_bits_;
    FieldTables<double> exact_;
    std::optional<FieldTables<float>> single_;          // the oracle in single precision, where the run is
    const std::size_t most_;                            // voxels of a kind
    std::array<std::vector<Voxel>, kVoxelKinds> drawn_; // heaps, the highest rank first
    std::uint64_t last_row_;                            // half the largest rank of a row that is drawn from
    std::vector<char> touched_;                         // of the plane before, whether there was a force
};

} // namespace forceshade
