// Units: text such as "N s/m" to its dimension and its exact factor to SI.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

namespace forceshade {

/// A product of powers of m, kg, s and rad. One such unit is numerator / denominator * 10^exponent * (pi / 180)^degrees
/// SI units. The factor is held as integers because a factor such as 1 mil = 254e-7 m is no binary number.
struct Unit {
    std::array<int, 4> powers{}; // of m, kg, s, rad
    std::uint64_t numerator = 1;
    std::uint64_t denominator = 1;
    int exponent = 0;
    int degrees = 0;
};

/// Reads factors separated by a space, `*` or `·`, divided by `/`, each with an integer power: "N/mm", "N s/m", "kg
/// m^2/s^2". Throws UsageError (without a location) for an unknown unit, with the nearest known one, and for an
/// ambiguous "N/m s".
Unit parse_unit(std::string_view text);

// Physical quantities: text such as "600 mil" to a number in SI units, its dimension checked.

enum class Dimension { length, force, stiffness, time, frequency, mass, damping, speed, angle, force_rate };

/// "length", and with its article "a length".
std::string_view dimension_name(Dimension dimension);
std::string dimension_with_article(Dimension dimension);

/// A quantity as one would write it: "0.2 mm".
std::string_view dimension_example(Dimension dimension);

/// The SI unit: "m", "N/m".
std::string_view dimension_unit(Dimension dimension);

/// Reads a number and a unit, independent of the locale, and returns it in SI units (m, N, N/m, s, Hz, kg, N s/m, m/s,
/// rad). Rounded once from the exact decimal value, unless the unit divides by mil or in or is an angle in degrees.
/// Throws UsageError (without a location) for a missing, unknown or wrong unit, and for what a double cannot hold.
double parse_quantity(std::string_view text, Dimension expected);

} // namespace forceshade
