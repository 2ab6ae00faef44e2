// A force volume thinned for the page.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

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

/// At most so many samples (at least one). \throws IoError for a file that cannot be read.
SampledVolume sample_volume(const std::filesystem::path& path, std::uint64_t most);

/// The force as halves of the power of two that the largest component does not exceed; each half less the one before
/// it along x; high bytes, then low bytes; compressed by zlib.
struct PackedForce {
    std::string bytes;
    double scale = 1; /* N */
};
PackedForce pack_force(const SampledVolume& volume);

/// IEEE 754 binary16, rounded to nearest even.
std::uint16_t half_of(float value);

} // namespace forceshade::report
