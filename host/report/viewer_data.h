// The volumes' data for the page: forces thinned and packed, the surface as sheets of heights, and some paths.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

namespace forceshade::report {

struct SampledVolume {
    std::array<std::uint64_t, 3> full{};   /* samples in the file */
    std::array<std::uint64_t, 3> stride{}; /* of the file's samples, every which one along x, y, z is here */
    std::array<std::uint64_t, 3> size{};   /* samples here */
    std::array<double, 3> origin{};        /* m, of the first sample */
    std::array<double, 3> spacing{};       /* m, of the file */
    bool alike_in_y = false;               /* one y stands for all */
    std::vector<float> force;              /* N: x, y, z of each sample, x fastest */
    std::string scene{};                   /* the resolved TOML; empty where the file names none */
};

/// At most `most` samples (at least one). \throws IoError for a file that cannot be read.
SampledVolume sample_volume(const std::filesystem::path& path, std::uint64_t most);

/// The force as halves of the power of two that the largest component does not exceed; each half less the one before
/// it along x; high bytes, then low bytes; compressed by zlib.
struct PackedForce {
    std::string bytes;
    double scale = 1; /* N */
};
PackedForce pack_force(const SampledVolume& volume);

/// {nominal, smooth}: the surface that depth is measured from, and the shape that shading imitates, if any,
/// each {unit_m, x: [...], z: [[...], ...]}: whole numbers of the unit, rows evenly along the volume's y, one row where
/// y does not matter. Null of a mesh or a map from a file, which volumes do not hold, and of a scene of another
/// version.
nlohmann::ordered_json surface_data(const SampledVolume& volume);

/// The loop of the scene: {mass, damping, grip, delay, period, stiffness} in SI; null where the scene does not say.
nlohmann::ordered_json loop_data(const std::string& scene);

/// s: between samples of a scene's paths; NaN where it does not say, as of recorded ones.
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
