// Checks of [paths] and [hand] that no single key can make.
#pragma once

#include "host/scene/selection.h"

#include <string>

namespace forceshade {

/// Throws UsageError at the offending key's place.
void check_paths(const Scene& scene, const Selection& selection, const std::string& source);

} // namespace forceshade
