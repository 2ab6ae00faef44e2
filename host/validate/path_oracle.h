// Explored paths held against the oracle in the same precision: some of them, evenly chosen, or all.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include "host/path_output/row_gatherer.h"
#include "host/record/oracle_errors.h"
#include "host/validate/path_bound.h"

namespace forceshade {

/// Most samples that are compared where not all are asked for: about a second's work.
inline constexpr std::uint64_t kComparedSamples = std::uint64_t(1) << 20;

/// Evaluates the chosen paths of each batch once more, by reference::evaluate_paths on all cores. On hardware, whose
/// divisions and square roots may round otherwise, what is felt is held against the law at the very position where it
/// was felt, and an open loop's positions against the oracle's, within derived bounds (path_bound.h). On a mesh, where
/// a force follows from all before it, an open loop's may be off by 1e-3 of the largest in one sample of a hundred,
/// since a probe on an edge may be given to either facet; and of an open loop's metrics the work may be off by 1e-3 of
/// the effort: these two are chosen. A closed loop's course is not compared there: it follows from what it felt.
template <typename T> class PathOracle {
public:
    /// Of a case, which must outlive this. `input` is the oracle's own, its source is asked for other batches than the
    /// engine's. `exact_bits` as in OracleCheck. `most`: samples compared, evenly chosen paths; 0: all.
    PathOracle(const PreparedCase& prepared, const layout::PathInput<T>& input, bool exact_bits,
               std::uint64_t most = kComparedSamples);
    ~PathOracle();

    /// The engine's rows of a batch as they come, unless metrics alone were asked for; then its metrics. Of each sample
    /// no more than a window is held.
    void compare(const PathRows<T>& rows);
    void compare(std::size_t first, std::span<const layout::PathMetrics<T>> metrics);

    const PathError& error() const { return error_; }

private:
    struct Batch;
    struct Sample;
    void begin(std::size_t first, std::size_t count);
    void compare(const PathRows<T>& rows, const layout::PathChunk<T>& alike);
    void compare_sample(const PathRows<T>& rows, const layout::PathChunk<T>& alike, const Sample& sample);
    bool differs_beyond(const PathRows<T>& rows, const layout::PathChunk<T>& alike, const Sample& sample, double off);
    void end_mesh_paths();
    bool is_beyond(const PathRows<T>& rows, const Sample& sample);
    bool has_left(const PathRows<T>& rows, const Sample& sample) const;
    bool metrics_differ(const layout::PathMetrics<T>& computed, const layout::PathMetrics<T>& alike) const;
    void note(const std::string& text);

    layout::PathInput<T> input_;
    bool exact_bits_;
    std::optional<PathBound<T>> bound_; // on hardware, unless the surface is a mesh
    std::uint64_t every_;
    std::unique_ptr<Batch> batch_; // the oracle's, of the engine's present batch
    PathError error_;
};

extern template class PathOracle<float>;
extern template class PathOracle<double>;

} // namespace forceshade
