// Units: text such as "N s/m" to its dimension and its exact factor to SI.
#pragma once

#include <array>
#include <cstdint>
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

} // namespace forceshade
