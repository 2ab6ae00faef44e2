// The vibration of a tool that slides over a material, by models of recordings (Culbertson, Unwin & Kuchenbecker 2014),
// and their files (Culbertson, Lopez Delgado & Kuchenbecker 2014: the Penn Haptic Texture Toolkit).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "host/random.h"

namespace forceshade {

/// An autoregressive moving average (ARMA) model, as its line spectral frequencies: a mean of two such models is
/// stable.
struct VibrationModel {
    double speed = 0, force = 0; /* m/s, N: along the surface, along its normal */
    std::vector<double> ar, ma;  /* rad: ascending, between 0 and pi; `ma` may be empty */
    double variance = 0;         /* (m/s^2)^2: of the noise that excites the filter */
    double gain = 1;             /* 1: of the moving average */
};

/// The models of a material, at places of speed and normal force.
struct VibrationModels {
    std::string material;
    double rate = 0;                                            /* Hz: of the models' samples */
    double friction = std::numeric_limits<double>::quiet_NaN(); /* 1: Coulomb's coefficient; NaN if the file has none */
    double largest_speed = 0, largest_force = 0;                /* m/s, N: models hold up to here */
    std::vector<VibrationModel> models;                         /* at least one, all of the same orders */
    std::vector<std::array<std::size_t, 3>> triangles;          /* at least one: indices of models */
};

/// Reads an XML file of the Penn Haptic Texture Toolkit.
/// \throws IoError `file: ...`, UsageError `file:line: ...` where the XML is damaged, an element is missing, a number
/// is not finite or out of range, a unit is unknown, or counts do not agree.
VibrationModels read_vibration(const std::filesystem::path& file);

/// The coefficients 1, a1, a2, ... of the polynomial in z^-1 with these line spectral frequencies, rad.
std::vector<double> polynomial_of(std::span<const double> frequencies);

/// The acceleration of a tool that slides over a material, sample by sample. Neither allocates nor throws once made. A
/// copy goes on from the same state.
class Vibration {
public:
    /// \throws UsageError where `rate`, Hz, is neither the models' rate divided by a whole number nor that times one.
    Vibration(std::shared_ptr<const VibrationModels> models, double rate, std::uint64_t seed);
    /// A path begins: its noise depends on the seed and on this number alone.
    void begin(std::uint64_t path) noexcept;
    /// m/s^2: at the next sample, at a speed, m/s, and a normal force, N, cut to the models' range. Where either is 0
    /// or not finite it is 0, and the filter waits. A loop that is slower than the models gets every nth of their
    /// samples, a faster one gets each n times.
    double next(double speed, double force) noexcept;

private:
    void set_filter(double speed, double force) noexcept;
    double step() noexcept;

    std::shared_ptr<const VibrationModels> models_;
    std::uint64_t seed_;
    std::size_t steps_ = 1, repeats_ = 1; // of the filter per sample; samples per step
    std::size_t left_ = 0;                // repeats of the last step
    Random noise_;
    double speed_ = -1, force_ = -1;             // for which the filter was computed
    std::vector<double> ar_, ma_;                // coefficients, from 1 on
    double deviation_ = 0, gain_ = 0, last_ = 0; // m/s^2, 1, m/s^2
    std::vector<double> outputs_, excitations_;  // m/s^2: newest first
    std::vector<double> frequencies_, product_;  // scratch memory
};

} // namespace forceshade
