// The error of an evaluated field against the oracle in double precision, over voxels drawn while its chunks pass by;
// and of paths against the oracle in the same precision.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "host/field/case_law.h"
#include "host/field/prepared_case.h"
#include "host/output/record.h"
#include "host/output/rows.h"
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
    template <typename T> OracleError compare_some(std::span<const Voxel> voxels, const CaseLaw<T>& same) const;

    const PreparedCase& prepared_;
    const bool exact_bits_;
    CaseLaw<double> exact_;
    std::optional<CaseLaw<float>> single_;              // the oracle in single precision, where the run is
    const std::size_t most_;                            // voxels of a kind
    std::array<std::vector<Voxel>, kVoxelKinds> drawn_; // heaps, the highest rank first
    std::uint64_t last_row_;                            // half the largest rank of a row that is drawn from
    std::vector<char> touched_;                         // of the plane before, whether there was a force
};

// Explored paths compared with the oracle in the same precision: some of them, evenly chosen, or all.

/// Most samples that are compared where not all are asked for: about a second's work.
inline constexpr std::uint64_t kComparedSamples = std::uint64_t(1) << 20;

/// Evaluates the chosen paths of each batch once more, by reference::evaluate_paths on all cores. On hardware, whose
/// divisions and square roots may round otherwise, what was computed is compared with the law at the very position
/// where it was computed, and an open loop's positions against the oracle's, within derived bounds (path_oracle.cpp).
/// On a mesh, where a force follows from all before it, an open loop's may be off by 1e-3 of the largest in one sample
/// of a hundred, since a probe on an edge may be given to either facet; and of an open loop's metrics the work may be
/// off by 1e-3 of the effort: these two are chosen. A closed loop's course is not compared there: it follows from its
/// own forces; nor, on hardware, are forces through a virtual coupling, which follow from the samples before.
template <typename T> class PathOracle {
public:
    /// Of a case, which must outlive this. `input` is the oracle's own, its source is asked for other batches than the
    /// engine's. `exact_bits` as in OracleCheck. `most`: samples compared, evenly chosen paths; 0: all.
    PathOracle(const PreparedCase& prepared, const layout::PathInput<T>& input, bool exact_bits,
               std::uint64_t most = kComparedSamples);
    ~PathOracle();

    /// The engine's rows of a batch as they come, unless metrics alone were asked for; then its metrics. Of each sample
    /// no more than a window is in memory.
    void compare(const PathRows<T>& rows);
    void compare(std::size_t first, std::span<const layout::PathMetrics<T>> metrics);

    const PathError& error() const { return error_; }

private:
    struct Batch;
    struct Sample;
    void begin(std::size_t first, std::size_t count);
    void compare(const PathRows<T>& rows, const layout::PathChunk<T>& oracle);
    void compare_sample(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample);
    bool differs_beyond(const PathRows<T>& rows, const layout::PathChunk<T>& oracle, const Sample& sample, double off);
    void end_mesh_paths();
    bool is_beyond(const PathRows<T>& rows, const Sample& sample);
    double place_error(double size, const glm::dvec3& at) const;
    bool is_allowed(const layout::HandParams<T>* hand, const Reading& computed, const glm::dvec3& probe,
                    layout::uint channels) const;
    bool has_left(const PathRows<T>& rows, const Sample& sample) const;
    bool metrics_differ(const layout::PathMetrics<T>& computed, const layout::PathMetrics<T>& oracle) const;
    void note(const std::string& text);

    layout::PathInput<T> input_;
    bool exact_bits_;
    std::optional<RoundingBound> bound_; // on hardware
    std::uint64_t every_;
    std::unique_ptr<Batch> batch_; // the oracle's, of the engine's present batch
    PathError error_;
};

extern template class PathOracle<float>;
extern template class PathOracle<double>;

} // namespace forceshade
