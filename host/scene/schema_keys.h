// The rows of the schema's table, and the names that choose which of them apply.
#pragma once

#include <array>
#include <string_view>
#include <vector>

#include "host/scene/schema.h"

namespace forceshade {

// In the order of SurfaceKind and of MapFunction, of which the last is no function but a file.
inline constexpr std::array<std::string_view, 4> kSurfaceKinds{"bump", "cylinder_bump", "height_map", "mesh"};
inline constexpr std::array<std::string_view, 4> kMapFunctions{"cylinder", "dip", "sine", "gaussian"};

inline constexpr std::uint32_t kFormBumps = kFormBump | kFormCylinderBump;

// In the order of PathKind.
inline constexpr std::array<std::string_view, 8> kPathKinds{"strokes", "raster",      "circle",       "spiral",
                                                            "taps",    "random_walk", "minimum_jerk", "recorded"};

std::vector<Key> make_keys();

/// The keys of [surface] that a mesh alone has.
void add_mesh_keys(std::vector<Key>& keys);

/// The tables [paths] and [hand].
void add_path_keys(std::vector<Key>& keys);
void add_path_place_keys(std::vector<Key>& keys); // of [paths]: where they go
void add_hand_keys(std::vector<Key>& keys);

} // namespace forceshade
