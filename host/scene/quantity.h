// Physical quantities: text such as "600 mil" to a number in SI units, its dimension checked.
#pragma once

#include <string>
#include <string_view>

namespace forceshade {

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
