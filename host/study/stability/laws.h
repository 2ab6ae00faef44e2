// Closed forms of where a sampled loop stops being stable: a mass with damping against a spring whose force is held
// over a sample.
#pragma once

#include <optional>

#include <glm/mat3x3.hpp>

namespace forceshade::study {

/// A wall's K_crit, N/m: of `mass` kg with `damping` N s/m against K sampled every `period` s. Exact for the held
/// force.
double critical_stiffness(double mass, double damping, double period);

/// The same where the force comes one sample late.
double critical_stiffness_late(double mass, double damping, double period);

/// The largest K that is passive with `delay` samples of it, N/m: b = K T (1/2 + delay) (Colgate & Schenkel, without
/// the wall's own damping).
double passive_stiffness(double damping, double period, int delay);

/// 2 f_c / quantum, N/m: what friction of `coulomb` N holds still between two quanta of `quantum` m (Abbott & Okamura).
double friction_stiffness(double coulomb, double quantum);

/// Flutter: `slope` is -dF/dp per N/m of K, of the plane x-z. N/m above which a pair of complex modes grows where the
/// force is not held but continuous: b^2 sigma / (m omega^2); nothing where no pair is complex.
std::optional<double> flutter_stiffness(const glm::dmat3& slope, double mass, double damping);

} // namespace forceshade::study
