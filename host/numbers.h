// Numbers as a reader meets them: SI prefixes, decimal text, counts, times and sizes, independent of the locale.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace forceshade::numbers {

/// A power of ten of a base unit: "mm" (-3), "kN" (3); beyond the prefixes "10⁻³⁰ N".
struct Unit {
    int exponent = 0;
    std::string name;
};

/// Exponent of the leading decimal digit of `value` > 0, finite: 3 for 1000 and for 9999.
int decade(double value);

/// value / 10^exponent, also where 10^exponent alone would overflow or be denormal.
double divide_by_power_of_ten(double value, int exponent);

/// The unit in which `largest` > 0 reads as 1 to 999; lengths stay in km up to 10⁶ km. `base` is "N" or "m".
Unit choose_unit(double largest, std::string_view base);

/// "5 mm", or "5 × 10⁹ m" where there is no prefix.
std::string with_unit(const std::string& number, const Unit& unit);
/// " / mm", or " / (10⁹ m)", to follow the name of a quantity whose numbers are in that unit.
std::string per_unit(const Unit& unit);

/// "⁻³".
std::string superscript(int number);

/// `value` with that many decimals, true minus sign (U+2212), no negative zero.
std::string decimal(double value, int decimals);

/// The same without trailing zeros behind the point.
std::string trimmed(double value, int decimals);

/// `value` > 0 in three significant digits: "2.5", "31.2", "50000", "3.8 × 10⁶".
std::string three_digits(double value);

/// A size >= 0 in its unit: "16.8 N", "0 m".
std::string quantity_text(double value, std::string_view base);

/// The number of decimals, at most `most`, that `value` needs to be written to within 10^-most / 2.
int needed_decimals(double value, int most);

/// "−0.5", and "1.5×10⁵" for what is below 0.001 or from 100000 on.
std::string number_label(double value, int decimals);

/// A number with `digits` significant digits: "−12.5", "3.2×10⁻⁷".
std::string number_text(double value, int digits);

/// "1 hole", "3 holes"; `many` where it is not `one` and an s.
std::string counted(std::uint64_t count, std::string_view one, std::string_view many = {});

/// "12 345 678", with spaces that do not break.
std::string count_text(std::uint64_t count);

/// "1 min 5 s", "3.2 s".
std::string duration_text(double seconds);

/// "3.14 MB"
std::string size_text(double bytes);

} // namespace forceshade::numbers
