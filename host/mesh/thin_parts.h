// Parts of a mesh too thin for a god-object in single precision.
#pragma once

#include "host/mesh/structure.h"

namespace forceshade {

/// Whether straight in front of or behind the middle of some triangle another one stands within `reach`, in units of
/// the mesh's frame: a thin wall, a sharp wedge, or a narrow gap. Looks at 2^16 triangles at most, evenly chosen.
bool has_thin_parts(const MeshStructure& structure, double reach);

} // namespace forceshade
