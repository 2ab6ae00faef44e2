// What the kernels of paths read of a mesh and its law, on the device. For compute/*.cpp only.
#pragma once

#include "compute/input_buffers.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

class MeshPathInputs {
public:
    explicit MeshPathInputs(Device::Implementation& device) : buffers_(device, layout::kMeshPathBindRecorded) {}

    /// Uploads what the law reads. \throws DeviceError: out_of_memory for a table beyond the device's range.
    template <typename T> void upload(const layout::Law<T>& law);

    /// Uploads what a batch of paths moves by.
    template <typename T> void upload(const layout::PathInput<T>& input, const layout::PathBatch<T>& batch);

    /// The buffer of a binding below layout::kMeshPathBindRecorded; a small one where the scene has none.
    vk::Buffer buffer(layout::uint binding) const { return buffers_.buffer(binding); }

    /// Where the vertices begin in the vectors.
    layout::uint vertices() const { return vertices_; }

    /// Bytes copied so far.
    std::uint64_t uploaded() const { return buffers_.uploaded(); }

private:
    template <typename T> void upload_triangles(const layout::Law<T>& law);
    template <typename T> void upload_vectors(const layout::Law<T>& law);

    InputBuffers buffers_;
    layout::uint vertices_ = 0;
};

} // namespace forceshade::compute
