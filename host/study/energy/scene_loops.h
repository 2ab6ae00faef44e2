// Loops and maps of curl of a user's scene: its surface with every shading that it can have.
#pragma once

#include <vector>

#include "host/study/energy/curl.h"
#include "host/study/energy/loop_case.h"

namespace forceshade::study {

/// A scheme a case: below the surface from the middle of the region of the scene's paths (path_region; what the scene
/// leaves open follows from its surface; of a mesh half its box) to its end at larger x, and over its whole length. Out
/// as deep as the scene's paths go, else by 2 % of the region's length; back at depth_back, else half as deep. \throws
/// UsageError where the scene gives no room for a loop.
std::vector<LoopCase> scene_loops(const PreparedCase& scene);

/// A section of x and z through the middle of the same region for each scheme without a history.
std::vector<CurlMap> scene_curl_maps(const PreparedCase& scene, std::uint64_t columns);

} // namespace forceshade::study
