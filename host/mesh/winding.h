// The generalized winding number of a mesh (Jacobson et al. 2013), by a tree of moments far away (Barill et al. 2018).
#pragma once

#include "host/mesh/structure.h"

namespace forceshade {

/// The moments of each node's triangles and the edges where the surface ends.
std::shared_ptr<const MeshWinding> make_winding(const MeshStructure& structure);

} // namespace forceshade
