// A force field over a grid on a Vulkan device, chunk by chunk, so that the grid may be larger than the device's
// memory.
#pragma once

#include <functional>
#include <memory>

#include "compute/device.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

struct FieldKernelOptions {
    std::size_t chunk_bytes = std::size_t(32)
                              << 20; /* most for the results of one dispatch; halved while memory is short */
    std::size_t software_chunk_bytes = std::size_t(8)
                                       << 20; /* the same on a software device: two fit into its caches */
    std::uint32_t rows = 0; /* rows (of one y and z) an invocation evaluates; 0: as many as leave the device filled */
    bool packed_stores = true;  /* two reals a 64-bit word where the device has 64-bit integers (f32) */
    bool force_staging = false; /* copy through a staging buffer even where the host shares the memory */
};

/// Where the time of a field went, in seconds. Kernel time is the device's own where its queue keeps time.
struct FieldTimes {
    double compile = 0;   /* pipelines, if not yet compiled */
    double upload = 0;    /* tables and buffers */
    double kernel = 0;    /* the dispatches */
    double read_back = 0; /* copies to host memory; 0 where the kernel writes there itself */
    std::uint64_t dispatches = 0;
    std::uint64_t uploaded = 0; /* bytes of tables, plans and recorded positions */
};

/// Evaluates fields on one device; keeps pipelines and buffers from one field to the next. Not for two threads at once.
class FieldKernel {
public:
    explicit FieldKernel(Device& device, const FieldKernelOptions& options = {});
    ~FieldKernel();

    /// Evaluates the law at every sample, in T, and hands over consecutive chunks of rows in order (z, then y) while
    /// the device computes the next. Equal to reference<T> bit for bit on a software device. \throws DeviceError:
    /// out_of_memory, device_lost, unfinished (the driver ended a loop early), unsupported (no f64).
    template <typename T>
    FieldTimes evaluate(const layout::FieldInput<T>& input,
                        const std::function<void(const layout::FieldChunk<T>&)>& consume);

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace forceshade::compute
