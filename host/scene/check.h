// Checks of a whole scene that no single key can make: the cylinder's shape, ranges of the arithmetic, the limits of a
// grid.
#pragma once

#include <string>
#include <vector>

#include "host/scene/cases.h"

namespace forceshade {

/// Throws UsageError at the offending key's place. Adds warnings that are not there yet.
void check_scene(const Scene& scene, const Selection& selection, const std::string& source,
                 std::vector<std::string>& warnings);

// Checks of [paths] and [hand] that no single key can make.

/// Throws UsageError at the offending key's place.
void check_paths(const Scene& scene, const Selection& selection, const std::string& source);

} // namespace forceshade
