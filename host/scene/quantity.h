// Physical quantities: text such as "600 mil" to a number in SI units, its dimension checked.
#pragma once

#include <array>
#include <string>
#include <string_view>

namespace forceshade {

enum class Dimension { length, force, stiffness, time, frequency, mass, damping, speed, angle, force_rate };

struct DimensionInfo {
    std::string_view name;         // "length"
    std::string_view with_article; // "a length"
    std::string_view example;      // a quantity as one would write it: "0.2 mm"
    std::string_view unit;         // in SI: "m"
    std::array<int, 4> powers;     // of m, kg, s, rad
};

const DimensionInfo& dimension_info(Dimension dimension);

/// Reads a number and a unit, independent of the locale, and returns it in SI units (m, N, N/m, s, Hz, kg, N s/m, m/s,
/// rad). A unit is one or more factors separated by a space, `*` or `·`, divided by `/`, each with an integer power:
/// "N/mm", "N s/m", "kg m^2/s^2". Rounded once from the exact decimal value, unless the unit divides by mil or in or is
/// an angle in degrees. Throws UsageError (without a location) for a missing, wrong or unknown unit, with the nearest
/// known one, for an ambiguous "N/m s", and for what a double cannot hold.
double parse_quantity(std::string_view text, Dimension expected);

/// A number of SI units in the unit of a quantity that parse_quantity takes: in_unit_of("600 mil", 0.0127, length) is
/// "500 mil".
std::string in_unit_of(std::string_view quantity, double number, Dimension dimension);

} // namespace forceshade
