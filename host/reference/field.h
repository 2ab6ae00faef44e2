// The CPU oracle over a grid: the reference law at every sample, on all cores. Also the `--engine cpu` of the command
// line.
#pragma once

#include <cstddef>
#include <functional>

#include "shaders/shared/law.h"

namespace forceshade::reference {

/// What the evaluation may use.
struct FieldOptions {
    unsigned threads = 0;                            /* 0: most_threads() */
    std::size_t chunk_bytes = std::size_t(32) << 20; /* most bytes of results held at once */
};

/// Evaluates the law at every sample of the grid, in T, and hands over consecutive chunks of rows in order (z, then y).
/// The channels are those of `input.law.features`. Stops early when `consume` throws.
template <typename T>
void evaluate_field(const layout::FieldInput<T>& input, const FieldOptions& options,
                    const std::function<void(const layout::FieldChunk<T>&)>& consume);

/// The plan of a mesh's samples z in [z_first, z_first + z_count), z_first even; valid until it is asked for the next.
using PlanLayers = std::function<layout::MeshPlan(std::size_t z_first, std::size_t z_count)>;

/// L6 static, as evaluate_field() with the same bits: voxels outside of the plan are out of contact, and only a block's
/// candidates are tested.
template <typename T>
void evaluate_mesh_field(const layout::FieldInput<T>& input, const FieldOptions& options, const PlanLayers& plan,
                         const std::function<void(const layout::FieldChunk<T>&)>& consume);

} // namespace forceshade::reference
