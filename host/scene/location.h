// Where in a configuration something stands, and errors that say so.
#pragma once

#include <compare>
#include <cstdint>
#include <string>
#include <string_view>

namespace forceshade {

/// Counted from 1, in characters. Line 0: no place in a file, but a default or an override.
struct Location {
    std::uint32_t line = 0;
    std::uint32_t column = 0;
    friend auto operator<=>(const Location&, const Location&) = default;
};

/// `bump.toml:12:5: `, or `bump.toml: ` for line 0.
std::string location_prefix(std::string_view source, Location location);

/// Throws UsageError `bump.toml:12:5: message`.
[[noreturn]] void fail(std::string_view source, Location location, const std::string& message);

} // namespace forceshade
