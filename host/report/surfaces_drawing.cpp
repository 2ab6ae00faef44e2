// What the studies press, cut across, with the forces on it: drawn to one scale.
#include <cmath>
#include <functional>
#include <string>

#include <fmt/format.h>

#include "host/report/sections.h"
#include "host/touch/own_surfaces.h"

namespace forceshade::report {
namespace {

constexpr double kHalf = 1e3 * kOwnHalfWidth, kMapR = 1e3 * kMapRadius; /* mm */
constexpr double kScale = 10, kBorder = 4;                              /* px/mm, mm */
constexpr double kArrow = 30, kHead = 5;                                /* px */
constexpr double kGround = 108, kHeight = 136, kWidth = 2 * (kHalf + kBorder) * kScale;

struct Place {
    double x, y; // px
};
Place place_at(double x, double z) {
    return {(x + kHalf + kBorder) * kScale, kGround - z * kScale};
}

// mm: the bump's cylinder.
double arc_height(double x) {
    constexpr double kRadius = 1e3 * kOwnRadius;
    return std::abs(x) < kHalf ? std::sqrt(kRadius * kRadius - x * x) - std::sqrt(kRadius * kRadius - kHalf * kHalf)
                               : 0;
}
double arc_slope(double x) { // x over z of its normal
    constexpr double kRadius = 1e3 * kOwnRadius;
    return x / std::sqrt(kRadius * kRadius - x * x);
}
double vertex(int i, int facets) { // by equal arcs
    constexpr double kRadius = 1e3 * kOwnRadius;
    return kRadius * std::sin(std::asin(kHalf / kRadius) * (2.0 * i / facets - 1));
}

std::string line_to(const char* command, Place place) {
    return fmt::format("{}{:.1f},{:.1f}", command, place.x, place.y);
}

// From the surface outwards; `tilt`: x over z.
std::string arrow(Place from, double tilt) {
    const double size = std::hypot(1, tilt), x = tilt / size, z = 1 / size;
    const Place tip{from.x + kArrow * x, from.y - kArrow * z};
    const auto barb = [&](double side) {
        return Place{tip.x - kHead * (x + 0.6 * side * z), tip.y + kHead * (z - 0.6 * side * x)};
    };
    return line_to("M", from) + line_to("L", tip) + line_to("M", barb(1)) + line_to("L", tip) + line_to("L", barb(-1));
}

std::string path(const char* name, const std::string& lines) {
    return fmt::format("<path class=\"{}\" d=\"{}\"></path>", name, lines);
}

// A length along x below what is drawn.
std::string measure(double from, double to, double below, const std::string& words) {
    const Place left = place_at(from, -below), right = place_at(to, -below);
    const auto end = [](Place at) { return line_to("M", {at.x, at.y - 4}) + line_to("L", {at.x, at.y + 4}); };
    return path("measure", line_to("M", left) + line_to("L", right) + end(left) + end(right)) +
           fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\">{}</text>", (left.x + right.x) / 2, left.y - 3, words);
}

std::string figure_of(double height, const std::string& drawn, const std::string& words) {
    // Readers of HTML know the attribute by its small letters, too.
    return fmt::format("<figure class=\"surface\"><svg viewbox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\">{}</svg>"
                       "<figcaption>{}</figcaption></figure>\n",
                       kWidth, height, words, drawn, words);
}

using Tilt = std::function<double(double x)>;

std::string bump_panel(int facets, bool shaded, const std::string& words) {
    std::string lines = line_to("M", place_at(-kHalf - kBorder, 0)), smooth, forces;
    for (int i = 0; i <= facets; ++i)
        lines += line_to("L", place_at(vertex(i, facets), arc_height(vertex(i, facets))));
    lines += line_to("L", place_at(kHalf + kBorder, 0));
    for (int i = 0; i <= 40; ++i) {
        const double x = kHalf * (i / 20.0 - 1);
        smooth += line_to(i == 0 ? "M" : "L", place_at(x, arc_height(x)));
    }
    const int arrows = facets > 4 ? 2 : 5; // on a facet
    for (int i = 0; i < facets; ++i)
        for (int k = 0; k < arrows; ++k) {
            const double left = vertex(i, facets), right = vertex(i + 1, facets);
            const double x = std::lerp(left, right, (k + 0.5) / arrows);
            const double slope = (arc_height(right) - arc_height(left)) / (right - left);
            forces += arrow(place_at(x, arc_height(left) + slope * (x - left)), shaded ? arc_slope(x) : -slope);
        }
    return figure_of(kHeight,
                     path("facets", lines) + path("smooth", smooth) + path("forces", forces) +
                         measure(-kHalf, kHalf, 2, fmt::format("{:.4g} mm", 2 * kHalf)),
                     words);
}

// A plane whose forces are turned; 0: up.
std::string plane_panel(const Tilt& tilt, const std::string& words) {
    std::string forces;
    for (int i = 0; i <= 10; ++i) {
        const double x = 0.98 * kHalf * (i / 5.0 - 1);
        forces += arrow(place_at(x, 0), tilt(x));
    }
    return figure_of(
        kHeight,
        path("facets", line_to("M", place_at(-kHalf - kBorder, 0)) + line_to("L", place_at(kHalf + kBorder, 0))) +
            path("forces", forces),
        words);
}

// From in front and above, its far rows shifted to the right.
std::string mesh_panel(const std::string& words) {
    constexpr double kShift = 0.12, kRise = 0.4; // mm for a mm of y
    constexpr double kTall = 186;                // px
    constexpr int kCells = kMeshCells;
    const auto corner = [](int i, int j) {
        const double x = vertex(i, kCells), y = kHalf * (2.0 * j / kCells - 1); // mm
        const Place there = place_at(x + kShift * y, arc_height(x) + kRise * y);
        return Place{there.x, there.y + kRise * kHalf * kScale / 2};
    };
    std::string lines;
    for (int i = 0; i <= kCells; ++i)
        for (int j = 0; j <= kCells; ++j) {
            const auto line = [&](int to_i, int to_j) {
                if (to_i <= kCells && to_j <= kCells)
                    lines += line_to("M", corner(i, j)) + line_to("L", corner(to_i, to_j));
            };
            line(i + 1, j);
            line(i, j + 1);
            line(i + 1, j + 1);
        }
    return figure_of(kTall, path("cells", lines), words);
}

} // namespace

std::string surfaces_drawing() {
    const auto on_map = [](double side) {
        return [side](double x) { return side * x / std::sqrt(kMapR * kMapR - x * x); };
    };
    const std::string high = fmt::format("{:.2g} mm high", arc_height(0));
    return "<div class=\"surfaces\">\n" +
           bump_panel(8, false, "bump of 8 facets, " + high + ": the force jumps from facet to facet") +
           bump_panel(8, true, "shaded bump of 8 facets: the force is turned to that of the smooth shape (dashed)") +
           mesh_panel("mesh of 8 x 8 cells between the same arcs, 25.4 mm square, bare or with four shadings") +
           bump_panel(2, false, "bump of 2 facets") + bump_panel(2, true, "shaded bump of 2 facets") +
           plane_panel([](double) { return 0.0; }, "plane; textured, its forces sway with waves of 2 mm, 10 µm high") +
           plane_panel(on_map(1), "height map of a bump, R = 25.4 mm: the plane, with the bump's directions") +
           plane_panel(on_map(-1), "height map of a dip: the same, turned inwards") + "</div>\n";
}

} // namespace forceshade::report
