// Which loops the study of energy takes.
#pragma once

#include <vector>

#include "host/study/energy/bump_mesh.h"
#include "host/study/energy/loop_case.h"

namespace forceshade::study {

/// The paper's bump of one radius (mil): facets unshaded and shaded, both readings of depth, both reference
/// directions; the cylinder superposed on the plane; the plane shaded by a height map.
std::vector<LoopCase> bump_loops(double radius_mil, const std::vector<unsigned>& facets);

/// A mesh of the bump of 1000 mil with every shading, as static field and with the god-object.
std::vector<LoopCase> mesh_loops(MeshCells kind, unsigned cells);

/// The plane of the laws' table as a mesh with the cylinder's normals at its vertices.
std::vector<LoopCase> plane_mesh_loops(double radius_mil, unsigned cells);

} // namespace forceshade::study
