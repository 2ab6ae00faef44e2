// What a reader must know of the loops to read their numbers.
#pragma once

#include <string>
#include <vector>

#include "host/study/energy/loop_case.h"

namespace forceshade::study {

/// Of the study's own loops: K, depths, ways, what each surface is, meshes and their history.
std::vector<std::string> loop_notes();

/// Of a user's scene, whose loops these are.
std::vector<std::string> scene_notes(const PreparedCase& scene, const std::vector<LoopCase>& loops);

} // namespace forceshade::study
