// The parts that a structure is put together from: the tree over its triangles, and what lies across their edges.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "host/mesh/structure.h"
#include "shaders/shared/law.h"

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

/// Fills parts.triangle_neighbours and reals.edge_pseudonormals. Edges are matched by the places of their ends.
void connect_edges(MeshParts& parts, MeshReals<double>& reals, const std::vector<layout::uint>& places);

/// Fills reals.vertex_pseudonormals: for each place the sum of its triangles' normals, weighted by the angle there
/// (Baerentzen and Aanaes 2005).
void sum_pseudonormals(const MeshParts& parts, MeshReals<double>& reals, const std::vector<layout::uint>& places);

/// True if no edge's or vertex' pseudonormal is so short that rounding could turn what it says.
bool has_firm_pseudonormals(const MeshParts& parts, const MeshReals<double>& reals);

} // namespace forceshade
