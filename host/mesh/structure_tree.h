// The tree over triangles: four children a node, binned surface-area heuristic.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "shaders/shared/layout.h"

namespace forceshade {

/// The box of a triangle, rounded outwards to single precision.
struct TreeItem {
    std::array<float, 3> low;
    std::uint32_t triangle;
    std::array<float, 3> high;
    std::uint32_t unused;
};

/// Brings the items into the tree's order and returns its nodes, root first; leaves are runs of items. No path from the
/// root has more than reference::kMeshTreeDepth nodes, whatever the items. The same for any number of threads.
std::vector<layout::MeshNode> build_tree(std::vector<TreeItem>& items, unsigned leaf_triangles, unsigned threads);

} // namespace forceshade
