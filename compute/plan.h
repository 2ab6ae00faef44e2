// How work is cut into dispatches under a device's limits, what kernels are specialised to, and the tables that they
// read, of which only what the law needs goes to the device. Arithmetic only: no device is touched.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade::compute {

/// The size of a sample in a channel of the results.
struct Channel {
    layout::uint bit; /* layout::kChannel... */
    std::uint32_t reals, uints;

    constexpr std::size_t bytes(std::size_t real_size) const {
        return reals * real_size + uints * sizeof(layout::uint);
    }
};
inline constexpr std::array<Channel, 6> kChannels{{{layout::kChannelPosition, 3, 0},
                                                   {layout::kChannelForce, 3, 0},
                                                   {layout::kChannelDepth, 1, 0},
                                                   {layout::kChannelFacet, 0, 1},
                                                   {layout::kChannelProxy, 3, 0},
                                                   {layout::kChannelUnshaded, 3, 0}}};

/// Bytes that one sample takes in all channels, and in the channel that takes most.
struct SampleBytes {
    std::uint64_t all, largest;
};
SampleBytes bytes_per_sample(layout::uint channels, std::size_t real_size);

constexpr std::uint64_t divide_up(std::uint64_t value, std::uint64_t by) {
    return (value + by - 1) / by;
}

/// Rows of a layer, or paths, of a dispatch of work that is done in parts; and steps, many times, since a state is read
/// again after each.
constexpr std::size_t part_of(std::size_t all) {
    return std::max<std::size_t>(1, all * 2 / 5);
}
constexpr std::size_t part_of_steps(std::size_t all) {
    return std::max<std::size_t>(1, all / 16);
}

struct PlanLimits {
    std::uint64_t buffer_range = 0;      /* bytes that one storage buffer may span */
    std::uint64_t chunk_bytes = 0;       /* bytes that all results of one dispatch may take */
    std::uint32_t group_invocations = 0; /* least invocations of a work group */
    std::uint32_t group_count = 0;       /* most groups of a dispatch */
    std::uint32_t lanes = 1;             /* neighbouring x samples an invocation evaluates */
    std::uint32_t rows = 0;              /* rows an invocation evaluates; 0: as many as leave the device filled */
    std::uint32_t invocations = 0;       /* that fill the device */
    bool along_z = false;                /* an invocation's rows are of one y */
};

struct FieldPlan {
    std::uint32_t x_pitch = 0; /* samples a row takes in the buffers: x_count rounded up to whole invocations */
    std::uint32_t blocks = 0;  /* invocations side by side in a row */
    std::uint32_t rows = 0;    /* rows an invocation evaluates */
    std::uint32_t y_step = 0, z_step = 0; /* rows of a dispatch: y_step * z_step; y_step < ny only where z_step is 1 */
    bool along_z = false;                 /* an invocation's rows are of one y; else they are neighbours in memory */

    /// Invocations that cover a chunk.
    std::uint64_t invocations(std::uint64_t y_count, std::uint64_t z_count) const;
};

/// Cuts a grid of nx * ny * nz samples into chunks of consecutive rows.
/// \throws DeviceError (out_of_memory) if not even one row fits.
FieldPlan plan_field(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                     const PlanLimits& limits);

/// Samples of a dispatch of a mesh's field along y and z, in whole blocks but for the grid's end; where two layers do
/// not fit at all, of one layer, since the rows of a chunk follow each other in the grid. y_step < ny only where z_step
/// is 1.
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

/// How kernels loop over the corners of a facet, so that drivers do not end their loops.
struct FacetLoops {
    std::uint32_t unroll = 1;    /* corners an iteration */
    bool voxel_by_voxel = false; /* an invocation evaluates one voxel of a block */
};

/// \throws DeviceError (unsupported) where a facet has more corners than any of these loops allows.
FacetLoops facet_loops(const layout::Features& features, std::span<const layout::uint> facet_begins);

/// The work of a step of a path in a kernel.
struct StepWork {
    std::uint64_t iterations = 1; /* most of its loops in a step, the loop over steps included */
    std::uint64_t cost = 1;       /* in the time of an open-loop step over a bump */
    std::uint64_t bytes = 0;      /* that a sample takes in all buffers of a dispatch */
};

/// The work of a step over an analytic surface; `facets` of a bump, `real_size` in bytes.
StepWork step_work(const layout::Features& law, const layout::PathFeatures& features, std::uint64_t facets,
                   std::size_t real_size);

/// Steps of one dispatch over `paths` paths, at least 1: no more than a driver lets a loop iterate, than a slow device
/// takes within about a second, or than fit into `chunk_bytes`.
std::uint32_t steps_of_dispatch(const StepWork& work, std::uint64_t paths, std::uint64_t steps,
                                std::uint64_t chunk_bytes);

/// Values of the specialization constants, by their ids.
using Constants = std::array<std::uint32_t, layout::kSpecCount>;

/// Of a field; the size of work groups is left to whoever dispatches.
Constants constants_of(const layout::Features& law, FacetLoops loops = {});

/// Of paths.
template <typename T> Constants constants_of(const layout::PathInput<T>& input, FacetLoops loops = {});

// Tables by binding, from a law, a grid, a mesh and a batch of paths.

using PutTable = std::function<void(layout::uint binding, std::span<const std::byte> table)>;

/// A field's law and axes. Rows of the x axis are padded with their last sample to a multiple of `lanes`.
template <typename T>
void put_field_tables(const layout::FieldInput<T>& input, std::uint32_t lanes, const PutTable& put);

/// All that a mesh's field reads but the plan; rows are padded to whole blocks. Returns how each triangle is written as
/// a candidate.
template <typename T>
std::vector<layout::uint> put_mesh_tables(const layout::FieldInput<T>& input, const PutTable& put);

/// The law of paths over an analytic surface.
template <typename T> void put_path_tables(const layout::Law<T>& law, const PutTable& put);

/// The law of paths on a mesh. Returns where the vertices begin in the vectors.
template <typename T> layout::uint put_mesh_path_tables(const layout::Law<T>& law, const PutTable& put);

/// The motion of a batch of paths, at three bindings from `motions` on: motions, harmonics and hands.
template <typename T>
void put_batch_tables(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch, layout::uint motions,
                      const PutTable& put);

} // namespace forceshade::compute
