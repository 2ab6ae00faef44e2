// What the page shows in space beside a volume: the surface as sheets of heights, and some paths.
#pragma once

#include <cstddef>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "host/report/sampled_volume.h"

namespace forceshade::report {

/// {nominal, smooth}: the surface that depth is measured from, and the shape that shading imitates where there is one,
/// each {unit_m, x: [...], z: [[...], ...]}: whole numbers of the unit, rows evenly along the volume's y, one row where
/// y does not matter. Null of a mesh or a map from a file, which volumes do not hold, and of a scene of another
/// version.
nlohmann::ordered_json surface_data(const SampledVolume& volume);

/// The loop of the scene: {mass, damping, grip, delay, period, stiffness} in SI; null where the scene does not tell.
nlohmann::ordered_json loop_data(const std::string& scene);

/// s: between samples of a scene's paths; NaN where it does not tell, as of recorded ones.
double path_period(const std::string& scene);

/// Some paths, thinned until they take no more than about `budget` characters: {size: [samples, paths], rate_Hz of the
/// samples here (absent of recorded ones), scale: {NAME: N or m}}, and `force`, `position` and, if stored, `proxy` as
/// pack_force packs. \throws IoError as read_paths.
struct PackedPaths {
    nlohmann::ordered_json about;
    std::vector<std::pair<std::string, std::string>> vectors;
};
PackedPaths pack_paths(const std::filesystem::path& path, std::size_t budget);

} // namespace forceshade::report
