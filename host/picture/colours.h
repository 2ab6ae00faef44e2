// Colours and marks, the same as on the report's page. Of numbers: maps of d3 that are read in grey and without
// red-green vision, but for the cyclic one. Of series: by the name, in files and on the page alike.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace forceshade::picture {

class Canvas;
struct Point;

/// 8-bit sRGB.
struct Rgb8 {
    std::uint8_t r, g, b;
    friend bool operator==(const Rgb8&, const Rgb8&) = default;
};

/// 0x00RRGGBB.
constexpr std::uint32_t packed(Rgb8 c) {
    return static_cast<std::uint32_t>(c.r << 16 | c.g << 8 | c.b);
}

/// Where the force is zero.
inline constexpr Rgb8 kNoForceColour{255, 255, 255};
/// NaN values are drawn as a checker of these two, so that they stand out without colour vision too.
inline constexpr std::array<Rgb8, 2> kNonFiniteColours{Rgb8{255, 0, 200}, Rgb8{0, 0, 0}};

/// viridis; plasma, for a second quantity; blue, white, red; a rainbow that begins again where it ends.
enum class ColourMap { sequential, second, diverging, cyclic };

/// The colour at `share` of the map, in [0, 1].
Rgb8 colour_at(ColourMap map, double share);

/// A number for each name, of which colour and mark follow: known names have theirs everywhere, the others get in
/// their order the first colours that are left.
std::vector<std::size_t> series_numbers(std::span<const std::string> names);
/// {"direct": 0, ...}: the known names, for the page.
std::string known_series_json();

/// Those of the page (--plot-s0 and so on), again from the ninth on.
Rgb8 series_colour(std::size_t number);
/// Half way to white.
Rgb8 lighter(Rgb8 colour);
/// Seven shapes in the order of d3: circle, square, triangle, diamond, cross, star, wye.
void draw_mark(Canvas& canvas, std::size_t number, Point at);

} // namespace forceshade::picture
