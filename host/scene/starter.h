// Scenes to start from, which work as they stand.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace forceshade {

inline constexpr std::array<std::string_view, 5> kStarters{"bump", "mesh", "paths", "live", "experiment"};

/// A scene with comments, its keys explained in the schema's words. `what`: one of kStarters; of an experiment only the
/// stimuli. `mesh`: the file's name as the scene names it. `scene`: what the commands in its first lines call it.
std::string starter_scene(std::string_view what, std::string_view mesh, std::string_view scene);

} // namespace forceshade
