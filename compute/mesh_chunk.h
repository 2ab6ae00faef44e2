// How the grid of a mesh's field is cut into dispatches, and what one of them is told of the plan. Arithmetic only: no
// device is touched.
#pragma once

#include <cstddef>
#include <vector>

#include "compute/field_plan.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// Samples of a dispatch along y and z, in whole blocks but for the grid's end; where two layers do not fit at all, of
/// one layer, since the rows of a chunk follow each other in the grid. y_step < ny only where z_step is 1.
struct MeshChunkSteps {
    std::uint32_t y_step = 0, z_step = 0;
};

/// `chunk_bytes` is exceeded, four times at most, where that keeps two layers together.
/// \throws DeviceError (out_of_memory) if not even one row of blocks fits.
MeshChunkSteps plan_mesh_chunks(std::uint64_t x_pitch, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                                std::uint64_t buffer_range, std::uint64_t chunk_bytes);

/// The part of a plan that a chunk needs, as the kernel reads it (layout::kMeshBindPlan).
struct MeshChunkPlan {
    std::uint32_t blocks = 0;
    std::vector<layout::uint> words; /* kMeshBlockWords a block, then the candidates */
};

/// `candidates` says how each triangle is written. Blocks are ordered by the number of their candidates, so that
/// invocations side by side take equally long; `voxel_by_voxel` lists each once for each of its voxels.
void cut_plan(const layout::MeshPlan& plan, const layout::MeshChunkParams& chunk,
              const std::vector<layout::uint>& candidates, bool voxel_by_voxel, MeshChunkPlan& part);

} // namespace forceshade::compute
