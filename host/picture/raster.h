// A slice of magnitudes as pixels: each pixel shows the nearest sample, nothing is interpolated.
#pragma once

#include "host/picture/field_slice.h"

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

namespace forceshade::picture {

/// What a set of magnitudes holds.
struct Census {
    double largest = 0; /* N, of the finite ones; 0 if there is no force */
    std::size_t samples = 0;
    std::size_t zero = 0;
    std::size_t non_finite = 0;
};

Census take_census(std::span<const double> magnitude);
Census operator+(const Census& a, const Census& b);

/// The sample nearest to the middle of each of `pixels` equal parts of an axis, from its low end.
std::vector<std::size_t> nearest_samples(const std::vector<double>& samples, double spacing, int pixels);

/// width * height pixels 0x00RRGGBB, row 0 at the largest v; colours from 0 to `largest` (N).
std::vector<std::uint32_t> rasterise(const MagnitudeSlice& slice, int width, int height, double largest);

} // namespace forceshade::picture
