#include "host/limits/critical_stiffness.h"

#include <cmath>
#include <limits>
#include <numbers>

namespace forceshade {
namespace {

/// x' = x + q v + p F, v' = A v + r F over one sample, in units of the sample and of sample^2 / mass; e = b T / m.
struct Plant {
    explicit Plant(double e) : decay(std::exp(-e)) {
        constexpr double kSmall = 0.01; // below, differences would lose digits
        force_first = e < kSmall ? 1.0 / 2 - e * (1.0 / 6 - e * (1.0 / 24 - e * (1.0 / 120 - e / 720)))
                                 : (e - 1 + decay) / (e * e);
        force_second = e < kSmall ? 1.0 / 2 - e * (1.0 / 3 - e * (1.0 / 8 - e * (1.0 / 30 - e / 144)))
                                  : (1 - decay * (1 + e)) / (e * e);
    }

    // The place answers a force with (force_first z + force_second) / ((z - 1) (z - decay)).
    double decay, force_first, force_second;
};

/// rad: of the place behind the force, `delay` samples late, at an angle from 0 to pi, rad, of the unit circle.
double phase(const Plant& plant, double angle, double delay) {
    const double sine = std::sin(angle), cosine = std::cos(angle);
    return std::atan2(plant.force_first * sine, plant.force_first * cosine + plant.force_second) -
           (std::numbers::pi + angle) / 2 - std::atan2(sine, cosine - plant.decay) - delay * angle;
}

double gain(const Plant& plant, double angle) {
    const double cosine = std::cos(angle);
    const auto distance = [&](double a, double b) {
        return std::sqrt(a * a + b * b + 2 * a * b * cosine);
    }; // |a z + b|
    return distance(plant.force_first, plant.force_second) / (2 * std::sin(angle / 2) * distance(1, -plant.decay));
}

} // namespace

double critical_stiffness(double mass, double damping, double sample_time, std::uint64_t delay_samples) {
    constexpr std::uint64_t kLongest = 1000000;                                               // samples
    const double e = damping * sample_time / mass, unit = mass / (sample_time * sample_time); // 1, N/m
    if (!(mass > 0 && damping > 0 && sample_time > 0 && e > 0 && std::isfinite(e) && unit > 0 && std::isfinite(unit)) ||
        delay_samples > kLongest)
        return std::numeric_limits<double>::quiet_NaN();
    // The phase falls from -pi/2 on; where it is -pi, the force pushes on.
    const Plant plant(e);
    double low = 0, high = std::numbers::pi;
    for (int i = 0; i < 200; ++i) {
        const double middle = (low + high) / 2;
        (phase(plant, middle, static_cast<double>(delay_samples)) > -std::numbers::pi ? low : high) = middle;
    }
    return unit / gain(plant, high);
}

} // namespace forceshade
