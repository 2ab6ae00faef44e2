// What a picture is drawn from: plane slices of a force volume, whole or sub-sampled, as plain numbers.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace forceshade::picture {

/// Where the samples of a slice lie: horizontal u and vertical v, increasing; sample (i, j) is number j * u.size() + i.
struct SliceAxes {
    std::vector<double> u; /* m, at least one */
    std::vector<double> v; /* m, at least one */
    double u_spacing = 0;  /* m, of the grid sliced: a sample stands for the cell of this width around it */
    double v_spacing = 0;  /* m */
    double at_spacing = 0; /* m, of the grid along the third axis */
    double at = 0;         /* m: where the slice cuts the third axis */
};

/// Force vectors over a slice; (Fx, Fy, Fz) whatever u and v are.
struct FieldSlice {
    SliceAxes axes;
    std::vector<std::array<double, 3>> force; /* N */
};

/// |F| over a slice.
struct MagnitudeSlice {
    SliceAxes axes;
    std::vector<double> magnitude; /* N */
};

/// |F| of each sample, without overflow or underflow on the way; NaN where a component is not finite.
MagnitudeSlice magnitude_of(const FieldSlice& slice);

} // namespace forceshade::picture
