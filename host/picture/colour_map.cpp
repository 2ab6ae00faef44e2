#include "host/picture/colour_map.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <numbers>
#include <vector>

#include "d3_colours.h"

namespace forceshade::picture {
namespace {

// From "440154450256...": six digits a colour.
std::vector<Rgb8> colours_in(std::string_view digits) {
    std::vector<Rgb8> colours;
    for (; digits.size() >= 6; digits.remove_prefix(6)) {
        std::uint32_t value = 0;
        std::from_chars(digits.data(), digits.data() + 6, value, 16);
        colours.push_back({static_cast<std::uint8_t>(value >> 16), static_cast<std::uint8_t>(value >> 8),
                           static_cast<std::uint8_t>(value)});
    }
    return colours;
}

Rgb8 rounded(double r, double g, double b) {
    const auto part = [](double value) {
        return static_cast<std::uint8_t>(std::lround(std::clamp(value, 0.0, 255.0)));
    };
    return {part(r), part(g), part(b)};
}

Rgb8 ramp(const std::vector<Rgb8>& colours, double share) {
    const auto count = static_cast<double>(colours.size());
    return colours[static_cast<std::size_t>(std::clamp(std::floor(share * count), 0.0, count - 1))];
}

// d3.interpolateRdBu: a uniform cubic B-spline through the colours' components, from red to blue.
Rgb8 red_blue(double share) {
    static const std::vector<Rgb8> colours = colours_in(k_red_blue);
    const auto last = static_cast<int>(colours.size()) - 1;
    const int piece = std::min(static_cast<int>(share * last), last - 1);
    const double t = share * last - piece, t2 = t * t, t3 = t2 * t;
    const auto component = [&](std::uint8_t Rgb8::*of) {
        const auto at = [&](int i) { return static_cast<double>(colours[static_cast<std::size_t>(i)].*of); };
        const double before = piece > 0 ? at(piece - 1) : 2 * at(0) - at(1);
        const double after = piece < last - 1 ? at(piece + 2) : 2 * at(last) - at(last - 1);
        return ((1 - 3 * t + 3 * t2 - t3) * before + (4 - 6 * t2 + 3 * t3) * at(piece) +
                (1 + 3 * t + 3 * t2 - 3 * t3) * at(piece + 1) + t3 * after) /
               6;
    };
    return rounded(component(&Rgb8::r), component(&Rgb8::g), component(&Rgb8::b));
}

// d3.interpolateRainbow, in the colour space of Green 2011, "A colour scheme for the display of astronomical intensity
// images".
Rgb8 rainbow(double share) {
    const double away = std::fabs(share - 0.5), lightness = 0.8 - 0.9 * away;
    const double hue = (360 * share + 20) * std::numbers::pi / 180;
    const double strength = (1.5 - 1.5 * away) * lightness * (1 - lightness), c = std::cos(hue), s = std::sin(hue);
    return rounded(255 * (lightness + strength * (-0.14861 * c + 1.78277 * s)),
                   255 * (lightness + strength * (-0.29227 * c - 0.90649 * s)),
                   255 * (lightness + strength * 1.97294 * c));
}

} // namespace

Rgb8 colour_at(ColourMap map, double share) {
    static const std::vector<Rgb8> viridis = colours_in(k_viridis), plasma = colours_in(k_plasma);
    share = std::clamp(share, 0.0, 1.0);
    switch (map) {
    case ColourMap::sequential:
        return ramp(viridis, share);
    case ColourMap::second:
        return ramp(plasma, share);
    case ColourMap::diverging:
        return red_blue(1 - share);
    case ColourMap::cyclic:
        return rainbow(share);
    }
    return kNoForceColour;
}

} // namespace forceshade::picture
