// Devices held to a plane by a sampled force, and where they stop coming to rest.
#pragma once

#include <array>
#include <string>

#include <fmt/format.h>

namespace forceshade::testing {

/// The limits are rounded to a hundredth of a newton per metre.
struct Plant {
    double mass, damping, period; /* kg, N s/m, s */
    double limit, limit_late;     /* N/m: K_crit, and with a sample of delay */
};

inline constexpr std::array<Plant, 6> kPlants{{{0.075, 0.5, 1e-3, 1001.11, 333.95},
                                               {0.1, 1.0, 1e-3, 2003.34, 668.51},
                                               {0.1, 5.0, 1e-3, 10084.03, 3378.94},
                                               {0.1, 1.0, 1e-4, 20003.33, 6668.52},
                                               {0.05, 20, 1e-3, 42849.01, 14646.91},
                                               {0.01, 50, 1e-3, 165192.52, 48213.32}}};

/// A probe pressed into a plane, N/m, with 1 N, that begins so many times as deep as it rests; `paths` and `hand` are
/// further keys.
inline std::string pressed_scene(const Plant& plant, double stiffness, double depths, const std::string& paths = "",
                                 const std::string& hand = "") {
    return fmt::format("[force]\nstiffness = \"{} N/m\"\n[paths]\nlength = \"0 m\"\npress = \"1 N\"\n"
                       "start_depth = \"{} m\"\n{}[hand]\nmass = \"{} kg\"\ndamping = \"{} N s/m\"\n"
                       "grip_stiffness = \"0 N/m\"\ngrip_damping = \"0 N s/m\"\n{}",
                       stiffness, depths / stiffness, paths, plant.mass, plant.damping, hand);
}

} // namespace forceshade::testing
