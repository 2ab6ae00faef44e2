// A mesh from two opposite sides, with what is remarkable in it marked.
#pragma once

#include "host/mesh/marks.h"
#include "host/picture/picture.h"

namespace forceshade::picture {

/// Of a mesh with at least one triangle that has an area. Marks are drawn over everything, pale where the mesh hides
/// them. `unit` of lengths: "m", or what else stands in their place.
Picture draw_mesh(const Look& look, const std::vector<std::string>& notes, const Mesh& mesh, const MeshMarks& marks,
                  const std::string& unit = "m");

} // namespace forceshade::picture
