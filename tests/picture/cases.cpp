#include "tests/picture/cases.h"

#include <cmath>

namespace forceshade::picture::test {
namespace {

constexpr double kHalfWidth = 0.0127; /* m: a */
constexpr double kRadius = 0.01524;   /* m: R */

double cylinder_height(double x) {
    const double drop = std::sqrt((kRadius - kHalfWidth) * (kRadius + kHalfWidth));
    return std::fabs(x) < kHalfWidth ? std::sqrt(kRadius * kRadius - x * x) - drop : 0;
}

double facet_height(double x) {
    return std::fabs(x) < kHalfWidth ? cylinder_height(0) * (1 - std::fabs(x) / kHalfWidth) : 0;
}

GridSpec cube(std::array<std::uint64_t, 3> size, double corner, double spacing) {
    return {size, {corner, corner, corner}, {spacing, spacing, spacing}};
}

const Law kNothing = [](double, double, double) { return std::array<double, 3>{0, 0, 0}; };

Law displaced(const Law& law, double by) {
    return [law, by](double x, double y, double z) { return law(x - by, y - by, z - by); };
}

Law scaled(const Law& law, double length) {
    return [law, length](double x, double y, double z) { return law(x / length, y / length, z / length); };
}

Law patterned(const Law& law) { // a force that depends on y too
    return [law](double x, double y, double z) {
        std::array<double, 3> force = law(x, y, z);
        const double wave = 1 + 0.4 * std::sin(y / 0.002);
        return std::array<double, 3>{force[0] * wave, 0.2 * force[2] * (wave - 1), force[2] * wave};
    };
}

std::string long_name() {
    return "bump_radius-600mil_facets-2_shading-reference_depth-vertical_reference-direction-normal_texture-stiffness-"
           "0.2N-per-mm_grid-256x64x128_spacing-0.2mm";
}

void add_odd_grids(std::vector<Case>& all, const Law& bump) {
    all.push_back({"one_voxel", "one voxel", cube({1, 1, 1}, -0.001, 0.0002), bump, {}});
    all.push_back({"one_voxel_far", "one voxel, far", cube({1, 1, 1}, 1000.0000001, 1e-9), displaced(bump, 1001), {}});
    all.push_back({"plane_x", "one plane in x", {{1, 64, 128}, {0, -0.006, -0.01}, {2e-4, 2e-4, 2e-4}}, bump, {}});
    all.push_back({"plane_y", "one plane in y", {{256, 1, 128}, {-0.025, 0, -0.01}, {2e-4, 2e-4, 2e-4}}, bump, {}});
    all.push_back({"plane_z", "one plane in z", {{256, 64, 1}, {-0.025, -0.006, -0.01}, {2e-4, 2e-4, 2e-4}}, bump, {}});
    all.push_back({"two_cubed", "two samples an axis", cube({2, 2, 2}, -0.002, 0.001), bump, {}});
    all.push_back({"five", "few samples", cube({5, 5, 5}, -0.004, 0.002), bump, two_facet_lines()});
    all.push_back({"tall", "taller than wide", {{20, 30, 400}, {-0.002, -0.003, -0.07}, {2e-4, 2e-4, 2e-4}}, bump, {}});
    all.push_back({"deep", "long in y", {{8, 2000, 30}, {-0.002, -0.2, -0.003}, {2e-4, 2e-4, 2e-4}}, bump, {}});
    all.push_back({"far",
                   "1 km from the origin",
                   {{128, 32, 64}, {999.9755, 999.99, 999.99}, {4e-4, 4e-4, 4e-4}},
                   displaced(bump, 1000),
                   {}});
    all.push_back({"far_nanometres",
                   "1 nm spacing, 1 km from the origin",
                   cube({64, 64, 64}, -1000.00000012, 1e-9),
                   displaced(bump, -999.99),
                   {}});
    all.push_back({"nanometres", "1 nm spacing", cube({100, 40, 60}, -50e-9, 1e-9), scaled(bump, 4e-6), {}});
    all.push_back({"kilometres", "50 m spacing", cube({100, 40, 60}, -2000, 50), scaled(bump, 2e5), {}});
    all.push_back({"unlike", "1 nm by 1 m", {{50, 20, 30}, {0, 0, -1}, {1e-9, 1e-3, 0.05}}, bump, {}});
    all.push_back({"sampled",
                   "more samples than pixels",
                   {{600, 400, 30}, {-0.025, -0.006, -0.01}, {8.5e-5, 3e-5, 8.4e-4}},
                   bump,
                   two_facet_lines()});
}

} // namespace

Law two_facet_bump(double stiffness, bool shaded) {
    return [stiffness, shaded](double x, double, double z) -> std::array<double, 3> {
        const double force = stiffness * std::max(0.0, facet_height(x) - z);
        if (std::fabs(x) >= kHalfWidth)
            return {0, 0, force};
        const double rise = x < 0 ? cylinder_height(0) : -cylinder_height(0);
        const double run = std::hypot(cylinder_height(0), kHalfWidth);
        if (shaded)
            return {force * x / kRadius, 0, force * std::sqrt(1 - x * x / (kRadius * kRadius))};
        return {-force * rise / run, 0, force * kHalfWidth / run};
    };
}

SurfaceLines two_facet_lines() {
    SurfaceLines lines;
    lines.nominal = {{-1, 0}, {-kHalfWidth, 0}, {0, cylinder_height(0)}, {kHalfWidth, 0}, {1, 0}};
    for (int i = -200; i <= 200; ++i)
        lines.smooth.push_back({kHalfWidth * i / 200, cylinder_height(kHalfWidth * i / 200)});
    return lines;
}

Slices collect(const GridSpec& grid, const Law& law, bool repeat_y, const SliceChoice& choice) {
    SliceCollector collector(grid, repeat_y, choice);
    const std::uint64_t rows = repeat_y ? 1 : grid.size[1];
    std::vector<double> force(3 * grid.size[0] * rows);
    for (std::uint64_t k = 0; k < grid.size[2]; ++k) {
        for (std::uint64_t j = 0; j < rows; ++j)
            for (std::uint64_t i = 0; i < grid.size[0]; ++i) {
                const auto value = law(grid.at(0, i), grid.at(1, j), grid.at(2, k));
                std::copy(value.begin(), value.end(), &force[3 * (j * grid.size[0] + i)]);
            }
        collector.add(layout::FieldChunk<double>{grid.size[0], grid.size[0], 0, rows, k, 1, force, {}, {}, {}, {}});
    }
    return {collector.slice(), collector.tiles()};
}

std::vector<Case> cases() {
    const Law bump = two_facet_bump(1000, false), shaded = two_facet_bump(1000, true);
    const GridSpec usual{};
    std::vector<Case> all{
        {"unshaded", "bump_radius-600mil_facets-2_shading-none", usual, bump, two_facet_lines()},
        {"shaded", "bump_radius-600mil_facets-2_shading-reference", usual, shaded, two_facet_lines()},
        {"textured", "depends on y", usual, patterned(shaded), two_facet_lines()},
        {"no_force", "all zero", usual, kNothing, two_facet_lines()},
        {"long_name", long_name(), usual, shaded, two_facet_lines()},
        {"long_word", std::string(200, 'W'), usual, shaded, {}},
        {"odd_name", "bad \xff\xfe bytes\nand ümläute, 力 <&>", usual, shaded, {}},
        {"tiny_force", "K = 1e-9 N/m", usual, two_facet_bump(1e-9, false), two_facet_lines()},
        {"huge_force", "K = 1e12 N/m", usual, two_facet_bump(1e12, false), two_facet_lines()},
        {"beyond_prefixes", "K = 1e-30 N/m", usual, two_facet_bump(1e-30, false), {}},
        {"denormal", "K = 1e-310 N/m", usual, two_facet_bump(1e-310, false), {}},
        {"largest", "as much as a float holds", cube({16, 16, 16}, -0.01, 1e-3), two_facet_bump(1e40, false), {}},
    };
    add_odd_grids(all, bump);
    return all;
}

} // namespace forceshade::picture::test
