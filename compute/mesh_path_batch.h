// A batch of paths on a mesh on its way through its steps: what the kernels remember of each, and what they wrote.
// Memory that the host sees. For compute/*.cpp only.
#pragma once

#include <array>
#include <vector>

#include "compute/input_buffers.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// Paths that wait for a kernel: the hot one, the rare one, likewise without neighbours.
constexpr std::size_t kMeshPathLists = 3;
using WaitingPaths = std::array<std::vector<layout::uint>, kMeshPathLists>;

/// Updates that are the host's, and the paths that wait for them.
template <typename T> struct HostUpdates {
    std::vector<layout::uint> paths;
    std::vector<layout::MeshUpdate<T>> updates;
};

class MeshPathBatch {
public:
    explicit MeshPathBatch(Device::Implementation& device) : device_(device) {}

    /// The paths before their first steps, and room for `rows` steps of results and, if recorded, of positions.
    template <typename T>
    void begin(const layout::PathBatch<T>& batch, std::size_t steps, layout::uint channels, std::size_t rows,
               bool recorded);

    /// Bytes that a step of all paths takes.
    static std::size_t row_bytes(layout::uint channels, std::size_t paths, std::size_t real_size, bool recorded);

    template <typename T> void put_positions(std::span<const T> positions);

    /// What the paths wait for that have not come to `step_end` or their end.
    WaitingPaths waiting(std::uint32_t step_end) const;
    /// What is left to the host.
    template <typename T> HostUpdates<T> host_updates() const;
    template <typename T> void put(const HostUpdates<T>& done);
    /// Writes lists, one after the other; gives where each begins.
    std::array<std::uint32_t, kMeshPathLists> put_lists(const WaitingPaths& lists);
    /// Loops that a driver ended. \throws DeviceError (unfinished).
    void check_status() const;

    /// What was written of steps [step_first, step_first + step_count).
    template <typename T> layout::PathChunk<T> chunk(std::size_t step_first, std::size_t step_count) const;
    template <typename T> std::vector<layout::PathMetrics<T>> metrics() const;

    /// The buffer of a binding from layout::kMeshPathBindRecorded on.
    vk::Buffer buffer(layout::uint binding) const;
    std::size_t rows() const { return rows_; }
    std::size_t paths() const { return paths_; }

private:
    layout::uint& word(layout::uint field, std::size_t path) const {
        return reinterpret_cast<layout::uint*>(words_.mapped)[field * paths_ + path];
    }
    template <typename T> T& real(layout::uint field, std::size_t path) const {
        return reinterpret_cast<T*>(reals_.mapped)[field * paths_ + path];
    }
    void reserve(Buffer& buffer, std::size_t bytes) {
        grow(device_, buffer, std::max<std::size_t>(bytes, 16), vk::BufferUsageFlagBits::eStorageBuffer,
             Placement::host_read);
    }

    Device::Implementation& device_;
    Buffer recorded_, states_, words_, reals_, samples_, facets_;
    std::size_t first_ = 0, paths_ = 0, rows_ = 0;
    layout::uint channels_ = 0;
};

} // namespace forceshade::compute
