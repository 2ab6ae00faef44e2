// What a picture shows, in words.
#pragma once

#include <string>

#include "host/scene/study.h"

namespace forceshade::picture {

/// "Bump of 2 facets, radius 15.2 mm, shaded as its cylinder, stiffness 2 N/mm": the surface, its shading, and whatever
/// else varies in the case's study.
std::string title_of(const Case& one, bool with_shading = true);

/// "100 paths (strokes)".
std::string paths_title(const PathsSpec& paths);

} // namespace forceshade::picture
