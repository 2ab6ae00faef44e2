// The force field of a mesh over a grid on a Vulkan device, slab by slab and chunk by chunk.
#pragma once

#include <functional>
#include <memory>

#include "compute/field_kernel.h"

namespace forceshade::compute {

/// Gives the plan of the samples z in [z_first, z_first + z_count): blocks are numbered in the whole grid and begin at
/// even samples. The spans live until the next call.
using PlanSlab = std::function<layout::MeshPlan(std::size_t z_first, std::size_t z_count)>;

struct MeshKernelOptions {
    std::size_t chunk_bytes = std::size_t(32) << 20;         /* most for the results of one dispatch */
    std::size_t software_chunk_bytes = std::size_t(8) << 20; /* the same on a software device */
    std::size_t slab_voxels = std::size_t(1) << 20;          /* planned at once */
    bool force_staging = false; /* copy through a staging buffer even where the host shares the memory */
};

/// Evaluates fields of meshes on one device; keeps pipelines and buffers from one field to the next. Not for two
/// threads at once.
class MeshKernel {
public:
    explicit MeshKernel(Device& device, const MeshKernelOptions& options = {});
    ~MeshKernel();

    /// Evaluates the law (surface kSurfaceMesh) at every sample, in T, and hands over consecutive chunks of rows in
    /// order (z, then y) while the device computes the next. Samples of blocks that no plan lists are out of contact.
    /// `plan` is asked for one slab after the other, in order; without it `input.plan` is that of the whole grid. Equal
    /// to reference<T> bit for bit on a software device. \throws DeviceError: out_of_memory, device_lost, unfinished
    /// (the driver ended a loop early), unsupported (no f64, facets with too many corners).
    template <typename T>
    FieldTimes evaluate(const layout::FieldInput<T>& input,
                        const std::function<void(const layout::FieldChunk<T>&)>& consume, const PlanSlab& plan = {});

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace forceshade::compute
