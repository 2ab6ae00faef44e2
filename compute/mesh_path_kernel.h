// Exploration paths on a mesh, with the god-object's history, on a Vulkan device.
#pragma once

#include <functional>
#include <memory>
#include <span>

#include "compute/path_kernel.h"

namespace forceshade::compute {

struct MeshPathOptions {
    std::size_t batch_paths = 16384;                 /* most paths on the device at once */
    std::size_t chunk_bytes = std::size_t(64) << 20; /* most for the samples of a chunk of steps */
    std::uint32_t pause = 250;                       /* loops after which an invocation begins no other step */
    std::uint32_t rare_pause = 600;                  /* likewise, no other piece of one update */
    std::uint32_t limit = 3600;        /* loops that an invocation may run: up to 16 together share a driver's limit */
    std::uint32_t limit_alone = 29000; /* likewise, of one that has its neighbours' share */
};

/// What a run took.
struct MeshPathTimes : FieldTimes {
    std::uint64_t rare_updates = 0; /* of god-objects, left to the kernel of the rare cases */
    std::uint64_t host_updates = 0; /* left to the host: rests at edges and corners, what takes too many loops */
    double host = 0;                /* s: in them */
};

/// Does the updates of L6 that the kernels leave: those that begin or end at edges and corners, and those that take
/// more loops than an invocation may run.
template <typename T> using FinishUpdates = std::function<void(std::span<layout::MeshUpdate<T>>)>;

/// Takes paths through a law of surface kSurfaceMesh; keeps pipelines and buffers from one run to the next. Not for two
/// threads at once.
class MeshPathKernel {
public:
    explicit MeshPathKernel(Device& device, const MeshPathOptions& options = {});
    ~MeshPathKernel();

    /// Takes every path of the input through its law, in T. Chunks come batch of paths by batch of paths, within one in
    /// the order of steps, if any channel is asked for; then the metrics of the batch. Equal to reference<T> bit for
    /// bit on a software device if `finish` does as it would. \throws DeviceError: out_of_memory, device_lost,
    /// unfinished (the driver ended a loop early), unsupported (no double precision, which either T needs; facets with
    /// too many corners).
    template <typename T>
    MeshPathTimes explore(const layout::PathInput<T>& input, const FinishUpdates<T>& finish, const TakePaths<T>& take,
                          const TakeMetrics<T>& take_metrics);

private:
    struct Implementation;
    std::unique_ptr<Implementation> implementation_;
};

} // namespace forceshade::compute
