// What lies across the edges of a structure's triangles, and the angle-weighted normals by which inside is told
// (Baerentzen and Aanaes 2005).
#pragma once

#include "host/mesh/structure.h"

namespace forceshade {

/// Fills parts.triangle_neighbours and reals.edge_pseudonormals. Edges are matched by the places of their ends.
void connect_edges(MeshParts& parts, MeshReals<double>& reals, const std::vector<layout::uint>& places);

/// Edges that triangles walk more often one way than the other, three numbers each: two vertices and by how often.
std::vector<layout::uint> find_rims(const MeshParts& parts, const std::vector<layout::uint>& places);

/// True if no edge's or vertex' pseudonormal is so short that rounding could turn what it says.
bool has_firm_pseudonormals(const MeshParts& parts, const MeshReals<double>& reals);

/// Fills reals.vertex_pseudonormals: for each place the sum of its triangles' normals, weighted by the angle there.
void sum_pseudonormals(const MeshParts& parts, MeshReals<double>& reals, const std::vector<layout::uint>& places);

} // namespace forceshade
