#include "host/study/stability/laws.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace forceshade::study {
namespace {

// The plant x' = x + q v + p F, v' = A v + r F, in units of T, T^2 / m and T / m.
struct HeldPlant {
    double keeps, q, p; /* A; q also stands for r */
    double p_unit;      /* m/N: T^2 / m */

    double s() const { return q * q - p * keeps; } // q r - p A
};

HeldPlant held_plant(double mass, double damping, double period) {
    const double e = damping * period / mass;
    HeldPlant plant{};
    plant.keeps = std::exp(-e);
    plant.q = e > 0 ? -std::expm1(-e) / e : 1;
    plant.p_unit = period * period / mass;
    constexpr double kSmall = 1e-2; // below, 1 - q loses digits
    if (e > kSmall) {
        plant.p = (1 - plant.q) / e;
    } else {
        double term = 0.5; // (-e)^n / (n + 2)!
        for (int n = 0; n < 8; ++n) {
            plant.p += term;
            term *= -e / (n + 3);
        }
    }
    return plant;
}

double one_minus_keeps(double mass, double damping, double period) {
    return -std::expm1(-damping * period / mass);
}

} // namespace

double critical_stiffness(double mass, double damping, double period) {
    const HeldPlant plant = held_plant(mass, damping, period);
    const double growing = one_minus_keeps(mass, damping, period) / plant.s();
    const double alternating_divisor = plant.p * (1 + plant.keeps) - plant.q * plant.q;
    const double alternating =
        alternating_divisor > 0 ? 2 * (1 + plant.keeps) / alternating_divisor : std::numeric_limits<double>::infinity();
    return std::min(growing, alternating) / plant.p_unit;
}

double critical_stiffness_late(double mass, double damping, double period) {
    const HeldPlant plant = held_plant(mass, damping, period);
    const double s = plant.s(), linear = plant.p + s * (1 + plant.keeps);
    const double rest = one_minus_keeps(mass, damping, period);
    return 2 * rest / (linear + std::sqrt(linear * linear + 4 * s * s * rest)) / plant.p_unit;
}

double passive_stiffness(double damping, double period, int delay) {
    return damping / (period * (0.5 + delay));
}

double friction_stiffness(double coulomb, double quantum) {
    return 2 * coulomb / quantum;
}

std::optional<double> flutter_stiffness(const glm::dmat3& slope, double mass, double damping) {
    const double xx = slope[0][0], xz = slope[2][0], zx = slope[0][2], zz = slope[2][2]; // columns first
    const double sigma = (xx + zz) / 2, square = xx * zz - xz * zx - sigma * sigma;
    if (!(square > 0) || !(sigma > 0))
        return std::nullopt;
    return damping * damping * sigma / (mass * square);
}

} // namespace forceshade::study
