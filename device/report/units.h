// Numbers for a person: three digits, an SI prefix, a unit.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace forceshade::device {

struct NumberStyle {
    bool zeros = false;           // behind the point: "1.20 us" and not "1.2 us", to stand in a column
    std::string_view micro = "u"; // "µ" in a picture
};

/// `value` in the unit `base` to three significant digits: "412 ns", "-1.2 mJ", "3.4 kHz". Seconds and lengths have no
/// prefix for thousands. No finite number is "unknown".
std::string quantity(double value, std::string_view base, const NumberStyle& style = {});

/// A time in ns.
std::string time_text(double nanoseconds, const NumberStyle& style = {});

/// " (0.5 %)", nothing of nothing. Never "0 %" of some, nor "100 %" of fewer than all.
std::string share_text(std::uint64_t part, std::uint64_t whole);

/// "1 sample", "2 samples".
std::string counted(std::uint64_t count, std::string_view noun);

} // namespace forceshade::device
