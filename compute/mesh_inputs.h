// What the mesh kernel reads: the law, the axes and the mesh, on the device. For compute/*.cpp only.
#pragma once

#include <vector>

#include "compute/input_buffers.h"
#include "shaders/shared/layout.h"

namespace forceshade::compute {

class MeshInputs {
public:
    explicit MeshInputs(Device::Implementation& device) : buffers_(device, layout::kMeshBindPlan) {}

    /// Uploads everything that the law reads but the plan. \throws DeviceError: out_of_memory for a table beyond the
    /// device's range.
    template <typename T> void upload(const layout::FieldInput<T>& input);

    /// The buffer of a binding below layout::kMeshBindPlan; a small one where the scene has none.
    vk::Buffer buffer(layout::uint binding) const { return buffers_.buffer(binding); }

    /// How a triangle of the mesh is written as a candidate.
    const std::vector<layout::uint>& candidates() const { return candidates_; }
    /// Samples of a row as stored: whole blocks.
    std::uint32_t x_pitch() const { return x_pitch_; }

    /// Bytes copied so far.
    std::uint64_t uploaded() const { return buffers_.uploaded(); }

private:
    template <typename T> void upload_triangles(const layout::MeshView<T>& mesh, const layout::Features& features);
    template <typename T> void upload_vertices(const layout::MeshView<T>& mesh, const layout::Features& features);
    template <typename T> void upload_facets(const layout::MeshView<T>& mesh, const layout::Features& features);

    InputBuffers buffers_;
    std::vector<layout::uint> candidates_;
    std::uint32_t x_pitch_ = 0;
};

} // namespace forceshade::compute
