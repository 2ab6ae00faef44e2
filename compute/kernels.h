// The kernels on a Vulkan device: force fields over grids, exploration paths, and both on meshes. Work is handed over
// chunk by chunk, so that it may be larger than the device's memory. A kernel keeps pipelines and buffers from one call
// to the next, is not for two threads at once, and equals reference<T> bit for bit on a software device.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "compute/device.h"
#include "shaders/shared/law.h"

namespace forceshade::compute {

/// Where the time went, in seconds. Kernel time is the device's own where its queue keeps time.
struct FieldTimes {
    double compile = 0;   /* pipelines, if not yet compiled */
    double upload = 0;    /* tables and buffers */
    double kernel = 0;    /* the dispatches */
    double read_back = 0; /* copies to host memory; 0 where the kernel writes there itself */
    std::uint64_t dispatches = 0;
    std::uint64_t uploaded = 0;     /* bytes of tables, plans and recorded positions */
    std::uint64_t host_updates = 0; /* of god-objects, left to the host */
    std::uint32_t group = 0;        /* invocations of a work group, of the last dispatch */
};

class Dispatcher;
struct DispatchShape;

/// Receives samples of a field.
template <typename T> using TakeField = std::function<void(const layout::FieldChunk<T>&)>;
/// Receive samples of paths, and the metrics of consecutive paths from `first` on when they have ended.
template <typename T> using TakePaths = std::function<void(const layout::PathChunk<T>&)>;
template <typename T>
using TakeMetrics = std::function<void(std::size_t first, std::span<const layout::PathMetrics<T>>)>;

/// Of any kernel; each reads those that it has a use for.
struct KernelOptions {
    std::size_t chunk_bytes = std::size_t(32)
                              << 20; /* most for the results of one dispatch; halved while memory is short */
    std::size_t software_chunk_bytes = std::size_t(8)
                                       << 20; /* the same of fields on a software device: two fit into its caches */
    bool force_staging = false;               /* copy through a staging buffer even where the host shares the memory */
    bool in_parts = false;                    /* below */
    // Of fields of analytic surfaces.
    std::uint32_t rows = 0; /* rows (of one y and z) an invocation evaluates; 0: as many as leave the device filled */
    bool packed_stores = true; /* two reals a 64-bit word where the device has 64-bit integers (f32) */
    // Of meshes' fields.
    std::size_t slab_voxels = std::size_t(1) << 20; /* planned at once */
    // Of paths.
    std::size_t batch_paths = 16384; /* most paths whose tables are held at once, or that are on the device at once */
    std::uint32_t steps = 0;         /* of a dispatch; 0: as many as end within a second, and no driver breaks off */
    // Of paths on meshes.
    std::uint32_t pause = 250;  /* loops after which an invocation begins no other step */
    std::uint32_t limit = 3600; /* loops that an invocation may run: up to 16 together share a driver's limit */
};

// In parts: the same work in dispatches of two fifths of a layer (of the paths, and a sixteenth of their steps), whose
// buffers hold no numbers before they run, and must not be written behind their ends. So whoever compares sees a first
// sample or a stride that is taken for another, and a result that is not written.

/// What all kernels have.
class Kernel {
public:
    void set_in_parts(bool in_parts) { options_.in_parts = in_parts; }

protected:
    Kernel(Device& device, const KernelOptions& options, const DispatchShape& shape);
    ~Kernel();

    std::unique_ptr<Dispatcher> dispatcher_;
    KernelOptions options_;
};

/// Fields of analytic surfaces.
class FieldKernel : public Kernel {
public:
    explicit FieldKernel(Device& device, const KernelOptions& options = {});

    /// Evaluates the law at every sample, in T, and hands over consecutive chunks of rows in order (z, then y) while
    /// the device computes the next. \throws DeviceError: out_of_memory, device_lost, unfinished (the driver ended a
    /// loop early), unsupported (no f64).
    template <typename T> FieldTimes evaluate(const layout::FieldInput<T>& input, const TakeField<T>& take);
};

/// Gives the plan of the samples z in [z_first, z_first + z_count): blocks are numbered in the whole grid and begin at
/// even samples. The spans live until the next call.
using PlanSlab = std::function<layout::MeshPlan(std::size_t z_first, std::size_t z_count)>;

/// Fields of meshes.
class MeshKernel : public Kernel {
public:
    explicit MeshKernel(Device& device, const KernelOptions& options = {});

    /// As FieldKernel::evaluate, for a law of surface kSurfaceMesh. Samples of blocks that no plan lists are out of
    /// contact. `plan` is asked for one slab after the other, in order; without it `input.plan` is that of the whole
    /// grid. \throws DeviceError: also unsupported for facets with too many corners.
    template <typename T>
    FieldTimes evaluate(const layout::FieldInput<T>& input, const TakeField<T>& take, const PlanSlab& plan = {});
};

/// Paths over analytic surfaces (L1 to L5, L8).
class PathKernel : public Kernel {
public:
    explicit PathKernel(Device& device, const KernelOptions& options = {});

    /// Takes every path of the input through its law, in T, and hands over chunks while the device computes the next:
    /// batch by batch, within one in the order of steps; then the batch's metrics. \throws DeviceError: out_of_memory,
    /// device_lost, unfinished (the driver ended a loop early), unsupported (no f64).
    template <typename T>
    FieldTimes explore(const layout::PathInput<T>& input, const TakePaths<T>& take, const TakeMetrics<T>& take_metrics);
};

/// Does the updates of L6 that the kernel leaves: those that meet what the host could not list beforehand, those that
/// begin or end at edges and corners, and those that take more loops than an invocation may run.
template <typename T> using FinishUpdates = std::function<void(std::span<layout::MeshUpdate<T>>)>;

/// Paths on meshes, with the god-object's history.
class MeshPathKernel : public Kernel {
public:
    explicit MeshPathKernel(Device& device, const KernelOptions& options = {});

    /// As PathKernel::explore, for a law of surface kSurfaceMesh; equal to reference<T> if `finish` does as it would.
    /// \throws DeviceError: unsupported also for facets with too many corners.
    template <typename T>
    FieldTimes explore(const layout::PathInput<T>& input, const FinishUpdates<T>& finish, const TakePaths<T>& take,
                       const TakeMetrics<T>& take_metrics);
};

} // namespace forceshade::compute
