#include "host/picture/colour_map.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

namespace forceshade::picture {
namespace {

struct Chroma {
    double a, b;
};

// Control points (chroma, hue in degrees) of the path's projection onto OKLab's a-b plane, a cubic Bezier curve:
// violet, blue, green, yellow. Found by a search for the longest curve (most colours to tell apart) inside the sRGB
// gamut.
constexpr std::array<std::array<double, 2>, 4> kControl{{{0.105, 294}, {0.123, 236}, {0.176, 155}, {0.164, 102}}};
constexpr double kDarkest = 0.22;
constexpr double kLightest = 0.93;

Chroma control_point(std::size_t i) {
    const double hue = kControl[i][1] * std::numbers::pi / 180;
    return {kControl[i][0] * std::cos(hue), kControl[i][0] * std::sin(hue)};
}

Chroma bezier(double t) {
    const double s = 1 - t;
    const std::array<double, 4> weight{s * s * s, 3 * s * s * t, 3 * s * t * t, t * t * t};
    Chroma sum{0, 0};
    for (std::size_t i = 0; i < weight.size(); ++i) {
        const Chroma point = control_point(i);
        sum.a += weight[i] * point.a;
        sum.b += weight[i] * point.b;
    }
    return sum;
}

// Lightness is linear in the index and the chroma curve is walked at constant speed, so the speed of both together is
// constant.
std::array<Oklab, kColourCount> compute_oklab() {
    constexpr std::size_t kSteps = 8192;
    std::vector<Chroma> point(kSteps + 1);
    std::vector<double> length(kSteps + 1, 0.0);
    for (std::size_t i = 0; i <= kSteps; ++i) {
        point[i] = bezier(static_cast<double>(i) / kSteps);
        if (i > 0)
            length[i] = length[i - 1] + std::hypot(point[i].a - point[i - 1].a, point[i].b - point[i - 1].b);
    }
    std::array<Oklab, kColourCount> map{};
    std::size_t segment = 0;
    for (std::size_t i = 0; i < kColourCount; ++i) {
        const double fraction = static_cast<double>(i) / (kColourCount - 1);
        const double target = fraction * length.back();
        while (segment + 2 <= kSteps && length[segment + 1] < target)
            ++segment;
        const double part = (target - length[segment]) / (length[segment + 1] - length[segment]);
        map[i] = {kDarkest + fraction * (kLightest - kDarkest), std::lerp(point[segment].a, point[segment + 1].a, part),
                  std::lerp(point[segment].b, point[segment + 1].b, part)};
    }
    return map;
}

std::uint8_t encode(double linear) {
    const double clamped = std::clamp(linear, 0.0, 1.0);
    const double gamma = clamped <= 0.0031308 ? 12.92 * clamped : 1.055 * std::pow(clamped, 1 / 2.4) - 0.055;
    return static_cast<std::uint8_t>(std::lround(255 * gamma));
}

double decode(std::uint8_t value) {
    const double gamma = value / 255.0;
    return gamma <= 0.04045 ? gamma / 12.92 : std::pow((gamma + 0.055) / 1.055, 2.4);
}

} // namespace

LinearRgb to_linear_rgb(const Oklab& c) {
    const double l = std::pow(c.L + 0.3963377774 * c.a + 0.2158037573 * c.b, 3);
    const double m = std::pow(c.L - 0.1055613458 * c.a - 0.0638541728 * c.b, 3);
    const double s = std::pow(c.L - 0.0894841775 * c.a - 1.2914855480 * c.b, 3);
    return {4.0767416621 * l - 3.3077115913 * m + 0.2309699292 * s,
            -1.2684380046 * l + 2.6097574011 * m - 0.3413193965 * s,
            -0.0041960863 * l - 0.7034186147 * m + 1.7076147010 * s};
}

Oklab to_oklab(const Rgb8& c) {
    const double r = decode(c.r), g = decode(c.g), b = decode(c.b);
    const double l = std::cbrt(0.4122214708 * r + 0.5363325363 * g + 0.0514459929 * b);
    const double m = std::cbrt(0.2119034982 * r + 0.6806995451 * g + 0.1073969566 * b);
    const double s = std::cbrt(0.0883024619 * r + 0.2817188376 * g + 0.6299787005 * b);
    return {0.2104542553 * l + 0.7936177850 * m - 0.0040720468 * s,
            1.9779984951 * l - 2.4285922050 * m + 0.4505937099 * s,
            0.0259040371 * l + 0.7827717662 * m - 0.8086757660 * s};
}

Rgb8 to_rgb8(const LinearRgb& c) {
    return {encode(c.r), encode(c.g), encode(c.b)};
}

const std::array<Oklab, kColourCount>& force_colours_oklab() {
    static const std::array<Oklab, kColourCount> map = compute_oklab();
    return map;
}

const std::array<Rgb8, kColourCount>& force_colours() {
    static const std::array<Rgb8, kColourCount> map = [] {
        std::array<Rgb8, kColourCount> rounded{};
        std::transform(force_colours_oklab().begin(), force_colours_oklab().end(), rounded.begin(),
                       [](const Oklab& colour) { return to_rgb8(to_linear_rgb(colour)); });
        return rounded;
    }();
    return map;
}

std::size_t colour_index(double magnitude, double largest) {
    const double position = magnitude / largest * static_cast<double>(kColourCount);
    return std::min(kColourCount - 1, static_cast<std::size_t>(position));
}

} // namespace forceshade::picture
