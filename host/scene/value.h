// Values of a configuration: where each stands and what it means.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "host/scene/toml.h"

namespace forceshade {

// One value of one key, as read: its meaning in SI units or as an index, the user's text, and where it stands.

struct Key;

struct Value {
    std::vector<double> numbers;         // a quantity's components, in SI units
    std::vector<std::uint64_t> integers; // integers, or the indices of choices
    std::vector<std::string> texts;      // the parts as written
    std::vector<Location> parts;         // where each part stands
    Location where;
    bool one_for_all = false; // one part stands for all components
    std::string path;         // of a file: absolute
    std::string sha256;       // of a file: as expected by the user, or empty
    std::string place;        // of a file: `source:line:column`
};

/// Equal text if and only if the values mean the same: "1000 mil" and "25.4 mm" are one value.
std::string identity(const Value& value);

/// The value as TOML, in the user's text; a file by its base name.
std::string literal(const Key& key, const Value& value);

/// The value in the user's text without quotes or brackets, parts joined by a separator.
std::string plain_text(const Value& value, char separator);

/// Reads one value, or each value of a sweep axis, of a key. File names are relative to `folder` (a path, may be
/// empty). Throws UsageError `source:line:column: message` if it is of a wrong type, unit, length or range.
std::vector<Value> read_values(const Key& key, const TomlNode& node, const std::string& source,
                               const std::string& folder);

// Physical quantities: text such as "600 mil" to a number in SI units, its dimension checked.

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
