// The stiffness up to which the loop of a mass on a sampled wall is stable, and up to which it is passive.
#pragma once

#include <cstdint>

namespace forceshade {

/// K_crit, N/m, of a mass, kg, with damping, N s/m, on a wall whose force is held for a sample, s, and `delay_samples`
/// late: where the loop first stays on the unit circle (hold and mass discretised exactly). NaN unless the first three
/// are above 0 and finite, and for a delay of more than a million samples.
double critical_stiffness(double mass, double damping, double sample_time, std::uint64_t delay_samples);

/// The largest K that gives no energy whatever holds the mass, N/m: K T (1/2 + delay) = b (Colgate & Schenkel 1997,
/// without the wall's own damping).
inline double passive_stiffness(double damping, double sample_time, std::uint64_t delay_samples) {
    return damping / (sample_time * (0.5 + static_cast<double>(delay_samples)));
}

} // namespace forceshade
