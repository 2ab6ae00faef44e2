// The surface of a scene as a section of constant y.
#pragma once

#include "host/study/energy/loop_case.h"

namespace forceshade::study {

/// From x = `first` to `last` at y, m: the nominal surface of bumps and plane, cut at vertices and rims; of a mesh what
/// a probe from above comes to first, straight between 64 casts (where nothing is below, the bottom of the mesh's box).
Section scene_section(const PreparedCase& prepared, double first, double last, double y);

} // namespace forceshade::study
