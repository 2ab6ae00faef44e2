// Where on a grid a mesh's field is not 0, and which triangles can be the nearest ones there: input of the mesh
// kernel. Conservative: a kernel that follows a plan gives what evaluating every voxel against every triangle would.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade {

/// Owns the data of a layout::MeshPlan.
struct BlockPlan {
    std::vector<layout::MeshBlock> blocks; /* by z */
    std::vector<layout::uint> candidates;  /* triangles */
    std::vector<layout::uint> inside;      /* layout::kInsideWinding: 8 bits a block */
    std::vector<layout::uint> wanted;      /* 8 bits a block, of the voxels that may be in contact; none: all may */
    std::uint64_t voxels_evaluated = 0;    /* of the grid, in listed blocks */

    layout::MeshPlan view() const { return {blocks, candidates, inside, wanted}; }
};

/// A run of candidates is no longer, whatever the mesh: where more triangles might be nearest, the planner finds the
/// nearest ones itself. So a plan takes at most 24 + 4 kMostCandidates bytes a block of 8 voxels.
constexpr layout::uint kMostCandidates = 512;

/// How blocks are planned in which no voxel can be inside.
enum class FreeSpace {
    skipped, /* not listed */
    visited, /* listed with their candidates: the same field for more work, which shows what skipping saves */
};

/// What evaluates the field that is planned: it decides how much time plans with fewer candidates save.
enum class Evaluator {
    processor, /* the CPU engine or a software device: in double precision it takes longer than planning */
    hardware,  /* a GPU: planning takes longest */
};

/// Plans the blocks of one mesh on one grid, a slab at a time: by halving boxes, or by scan conversion (solid_scan.h)
/// where that is faster. Results do not depend on the threads.
template <typename T> class BlockPlanner {
public:
    /// The grid x * y * z, coordinates in the mesh's frame, increasing. `inside` is layout::kInside...;
    /// kInsideWinding needs mesh.moments. All spans must outlive the planner. `threads` 0: most_threads().
    BlockPlanner(const layout::MeshView<T>& mesh, std::span<const T> x, std::span<const T> y, std::span<const T> z,
                 layout::uint inside, unsigned threads = 0, FreeSpace free = FreeSpace::skipped,
                 Evaluator evaluator = Evaluator::processor);
    ~BlockPlanner();

    /// Blocks of the samples z in [z_first, z_first + z_count), z_first even, in which a voxel may be inside; all of
    /// them where free space is visited.
    BlockPlan plan(std::size_t z_first, std::size_t z_count) const;

private:
    struct Implementation;
    std::unique_ptr<const Implementation> implementation_;
};

/// The plan of a whole grid.
template <typename T>
BlockPlan plan_blocks(const layout::MeshView<T>& mesh, std::span<const T> x, std::span<const T> y, std::span<const T> z,
                      layout::uint inside, unsigned threads = 0, FreeSpace free = FreeSpace::skipped) {
    return BlockPlanner<T>(mesh, x, y, z, inside, threads, free).plan(0, z.size());
}

} // namespace forceshade
