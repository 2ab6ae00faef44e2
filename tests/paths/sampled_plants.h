// Devices held to a plane by a sampled force, and where they stop coming to rest.
#pragma once

#include <array>

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

} // namespace forceshade::testing
