// The kernels' input from a law, a grid, a mesh and a batch of paths, as tables by binding. Only what the law reads
// goes to the device. No device is touched here.
#pragma once

#include <functional>
#include <vector>

#include "shaders/shared/law.h"

namespace forceshade::compute {

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

/// The triangles that may block a proxy that slides over a face, found once for a mesh, so that the kernel of paths
/// needs no tree for most steps: for each triangle, those that a proxy may approach while the plane of its front
/// holds it a skin away and it is above the triangle or no more than two skins outside of it; and the same at the back.
/// Triangles below that plane, as the law has it, are left out.
struct MeshObstacles {
    std::vector<layout::uint> triangles;
    std::vector<layout::uint> front; /* where a triangle's begin; those of its back follow, up to the next one's */
    std::vector<layout::uint> back;
    std::vector<bool> crowded; /* too many to list */
};

template <typename T> MeshObstacles find_obstacles(const layout::MeshView<T>& mesh);

} // namespace forceshade::compute
