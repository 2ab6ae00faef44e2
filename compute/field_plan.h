// How a grid is cut into dispatches under a device's limits. Arithmetic only: no device is touched.
#pragma once

#include <cstddef>
#include <cstdint>

#include "shaders/shared/layout.h"

namespace forceshade::compute {

struct PlanLimits {
    std::uint64_t buffer_range = 0;      /* bytes that one storage buffer may span */
    std::uint64_t chunk_bytes = 0;       /* bytes that all results of one dispatch may take */
    std::uint32_t group_invocations = 0; /* most invocations of a work group */
    std::uint32_t group_count = 0;       /* most groups of a dispatch */
    std::uint32_t abreast = 1;           /* neighbouring x samples an invocation evaluates */
    std::uint32_t rows = 0;              /* rows an invocation evaluates; 0: as many as leave the device filled */
    std::uint32_t invocations = 0;       /* what it takes to fill the device */
    bool along_z = false;                /* an invocation's rows are of one y */
};

struct FieldPlan {
    std::uint32_t x_pitch = 0; /* samples a row takes in the buffers: x_count rounded up to whole invocations */
    std::uint32_t group = 0;   /* invocations of a work group */
    std::uint32_t blocks = 0;  /* invocations side by side in a row */
    std::uint32_t rows = 0;    /* rows an invocation evaluates */
    std::uint32_t y_step = 0, z_step = 0; /* rows of a dispatch: y_step * z_step; y_step < ny only where z_step is 1 */
    bool along_z = false;                 /* an invocation's rows are of one y; else they are neighbours in memory */

    /// Work groups that cover a chunk.
    std::uint32_t groups(std::uint64_t y_count, std::uint64_t z_count) const;
};

/// Bytes that one sample takes in all channels, and in the channel that takes most.
struct SampleBytes {
    std::uint64_t all, largest;
};
SampleBytes bytes_per_sample(layout::uint channels, std::size_t real_size);

/// Cuts a grid of nx * ny * nz samples into chunks of consecutive rows.
/// \throws DeviceError (out_of_memory) if not even one row fits.
FieldPlan plan_field(std::uint64_t nx, std::uint64_t ny, std::uint64_t nz, SampleBytes sample,
                     const PlanLimits& limits);

} // namespace forceshade::compute
