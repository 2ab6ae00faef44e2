// What can stand in the way of a proxy that slides over a face: found once for a mesh, so that the kernel of paths
// needs no tree for most steps. Arithmetic only: no device is touched.
#pragma once

#include <vector>

#include "shaders/shared/layout.h"

namespace forceshade::compute {

/// For each triangle, those that a proxy may come close to while the plane of its front holds it a skin away and it is
/// above the triangle or no more than two skins beside it; and likewise at the back. What lies below that plane, as the
/// law has it, is left out.
struct MeshObstacles {
    std::vector<layout::uint> triangles;
    std::vector<layout::uint> front; /* where a triangle's begin; those of its back follow, up to the next one's */
    std::vector<layout::uint> back;
    std::vector<bool> crowded; /* too many to list */
};

template <typename T> MeshObstacles find_obstacles(const layout::MeshView<T>& mesh);

extern template MeshObstacles find_obstacles<float>(const layout::MeshView<float>&);
extern template MeshObstacles find_obstacles<double>(const layout::MeshView<double>&);

} // namespace forceshade::compute
