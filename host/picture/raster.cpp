#include "host/picture/raster.h"

#include "host/picture/colour_map.h"
#include "host/picture/ticks.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace forceshade::picture {
namespace {

constexpr int kCheckerSize = 4; // pixels: squares of the pattern that marks what is no number

std::uint32_t packed(Rgb8 c) {
    return static_cast<std::uint32_t>(c.r) << 16U | static_cast<std::uint32_t>(c.g) << 8U | c.b;
}

Rgb8 colour_of(double magnitude, double largest, int x, int y) {
    if (!std::isfinite(magnitude))
        return kNonFiniteColours[static_cast<std::size_t>((x / kCheckerSize + y / kCheckerSize) % 2)];
    if (magnitude == 0)
        return kNoForceColour;
    return force_colours()[colour_index(magnitude, largest)];
}

} // namespace

Census take_census(std::span<const double> magnitude) {
    Census census;
    census.samples = magnitude.size();
    for (const double value : magnitude) {
        if (!std::isfinite(value))
            ++census.non_finite;
        else if (value == 0)
            ++census.zero;
        else
            census.largest = std::max(census.largest, value);
    }
    return census;
}

Census operator+(const Census& a, const Census& b) {
    return {std::max(a.largest, b.largest), a.samples + b.samples, a.zero + b.zero, a.non_finite + b.non_finite};
}

std::vector<std::size_t> nearest_samples(const std::vector<double>& samples, double spacing, int pixels) {
    const double extent = axis_extent(samples, spacing);
    std::vector<std::size_t> nearest(static_cast<std::size_t>(pixels));
    std::size_t sample = 0;
    for (std::size_t i = 0; i < nearest.size(); ++i) {
        const double position = (static_cast<double>(i) + 0.5) / pixels * extent - spacing / 2; // from the first sample
        while (sample + 1 < samples.size() &&
               position > std::midpoint(samples[sample] - samples[0], samples[sample + 1] - samples[0]))
            ++sample;
        nearest[i] = sample;
    }
    return nearest;
}

std::vector<std::uint32_t> rasterise(const MagnitudeSlice& slice, int width, int height, double largest) {
    const std::vector<std::size_t> column = nearest_samples(slice.axes.u, slice.axes.u_spacing, width);
    const std::vector<std::size_t> row = nearest_samples(slice.axes.v, slice.axes.v_spacing, height);
    std::vector<std::uint32_t> pixels;
    pixels.reserve(column.size() * row.size());
    for (int y = 0; y < height; ++y) {
        const std::size_t line = row[static_cast<std::size_t>(height - 1 - y)] * slice.axes.u.size();
        for (int x = 0; x < width; ++x) {
            const double magnitude = slice.magnitude[line + column[static_cast<std::size_t>(x)]];
            pixels.push_back(packed(colour_of(magnitude, largest, x, y)));
        }
    }
    return pixels;
}

} // namespace forceshade::picture
