// The colours of numbers, the same as on the report's page: maps of d3 that are read in grey and without red-green
// vision, but for the cyclic one.
#pragma once

#include <array>
#include <cstdint>

namespace forceshade::picture {

/// 8-bit sRGB.
struct Rgb8 {
    std::uint8_t r, g, b;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// 0x00RRGGBB.
constexpr std::uint32_t packed(Rgb8 c) {
    return static_cast<std::uint32_t>(c.r << 16 | c.g << 8 | c.b);
}

/// Where there is no force.
inline constexpr Rgb8 kNoForceColour{255, 255, 255};
/// Values that are no number are drawn as a checker of these two, so that they stand out without colour vision too.
inline constexpr std::array<Rgb8, 2> kNonFiniteColours{Rgb8{255, 0, 200}, Rgb8{0, 0, 0}};

/// viridis; plasma, for a second quantity beside it; blue, white, red; a rainbow that begins again where it ends.
enum class ColourMap { sequential, second, diverging, cyclic };

/// The colour at `share` of the map, in [0, 1].
Rgb8 colour_at(ColourMap map, double share);

} // namespace forceshade::picture
