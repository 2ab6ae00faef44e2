// The hand and the device of a scene, as an engine takes them.
#pragma once

#include "host/scene/scene.h"
#include "shaders/shared/layout.h"

namespace forceshade {

/// In closed loop. The grip's spring pulls to the path along x and y, and along z unless the hand presses with a given
/// force; its damping acts on the speed against the path's, the device's on the speed. `bound`, m: PathRegion.
/// \throws UsageError if a value leaves the range of T.
template <typename T> layout::HandParams<T> hand_params(const HandSpec& hand, const PathsSpec& paths, double bound);

} // namespace forceshade
