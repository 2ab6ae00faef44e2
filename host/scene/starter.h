// Scenes to start from, which work as they stand.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace forceshade {

inline constexpr std::array<std::string_view, 5> kStarters{"bump", "mesh", "paths", "live", "experiment"};

/// The unit, m, cm, mm or um, in which `across` is nearest to what a hand holds, 0.1 m. Models without a size, 1 to 3
/// across, get cm.
std::string_view unit_for_a_hand(double across);

/// A scene with comments, its keys explained in the schema's words. `what`: one of kStarters; of an experiment only the
/// stimuli. `mesh`: the file's name as the scene names it, `unit` that of its numbers. `scene`: what the commands in
/// its first lines call it.
std::string starter_scene(std::string_view what, std::string_view mesh, std::string_view unit, std::string_view scene);

} // namespace forceshade
