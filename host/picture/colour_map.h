// The colours of a force magnitude: perceptually uniform, computed in OKLab, readable in grey and without red-green
// vision.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

namespace forceshade::picture {

/// A colour in OKLab (B. Ottosson, "A perceptual color space for image processing", 2020): L lightness in [0, 1].
struct Oklab {
    double L, a, b;
};

/// A colour in linear-light sRGB; in gamut if every component lies in [0, 1].
struct LinearRgb {
    double r, g, b;
};

/// 8-bit sRGB.
struct Rgb8 {
    std::uint8_t r, g, b;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

inline constexpr std::size_t kColourCount = 256;
inline constexpr Rgb8 kNoForceColour{255, 255, 255};
/// Values that are no number are drawn as a checker of these two, so that they stand out without colour vision too.
inline constexpr std::array<Rgb8, 2> kNonFiniteColours{Rgb8{255, 0, 200}, Rgb8{0, 0, 0}};

LinearRgb to_linear_rgb(const Oklab& colour);
Oklab to_oklab(const Rgb8& colour);
Rgb8 to_rgb8(const LinearRgb& colour);

/// The map before rounding: kColourCount colours from dark blue-violet to light yellow, neighbours at one OKLab
/// distance, lightness linear in the index.
const std::array<Oklab, kColourCount>& force_colours_oklab();
/// The same as 8-bit sRGB.
const std::array<Rgb8, kColourCount>& force_colours();

/// Index into the map of a finite magnitude in (0, largest]; `largest` > 0, same unit.
std::size_t colour_index(double magnitude, double largest);

} // namespace forceshade::picture
