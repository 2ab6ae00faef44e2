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
    std::array<std::size_t, 3> axis{0, 2, 1}; // which of x, y, z are u, v and the third
};

inline constexpr std::array kAxisNames{"x", "y", "z"};

/// Force vectors over a slice; (Fx, Fy, Fz) whatever u and v are.
struct FieldSlice {
    SliceAxes axes;
    std::vector<std::array<double, 3>> force; /* N */
};

} // namespace forceshade::picture
