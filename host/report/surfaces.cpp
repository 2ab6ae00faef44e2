// A drawing of what the studies press: a bump of facets, cut across, and the forces on it, unshaded and shaded.
#include <cmath>
#include <functional>

#include <fmt/format.h>

#include "host/report/sections.h"

namespace forceshade::report {
namespace {

constexpr double kHalf = 12.7, kRadius = 25.4; /* mm: the paper's width, and the radius of the studies' bump */
constexpr int kFacets = 5;
constexpr double kScale = 10, kBorder = 4; /* px/mm, mm */
constexpr double kArrow = 30, kHead = 5;   /* px */
constexpr double kGround = 78, kHeight = 88, kWidth = 2 * (kHalf + kBorder) * kScale;

struct Place {
    double x, y; // px
};

double arc_height(double x) {
    const double deep = std::sqrt(kRadius * kRadius - kHalf * kHalf);
    return std::abs(x) < kHalf ? std::sqrt(kRadius * kRadius - x * x) - deep : 0;
}
double vertex(int i) {
    const double half = std::asin(kHalf / kRadius); // by equal arcs
    return kRadius * std::sin(half * (2.0 * i / kFacets - 1));
}
Place shown(double x, double z) {
    return {(x + kHalf + kBorder) * kScale, kGround - z * kScale};
}

std::string line_to(const char* command, Place place) {
    return fmt::format("{}{:.1f},{:.1f}", command, place.x, place.y);
}

// From the surface outwards; `x` and `z` of a unit vector.
std::string arrow(Place from, double x, double z) {
    const Place tip{from.x + kArrow * x, from.y - kArrow * z};
    const auto barb = [&](double side) {
        return Place{tip.x - kHead * (x + 0.6 * side * z), tip.y + kHead * (z - 0.6 * side * x)};
    };
    return line_to("M", from) + line_to("L", tip) + line_to("M", barb(1)) + line_to("L", tip) + line_to("L", barb(-1));
}

// `direction`: of the force at x on the facet from `left` to `right`, x over z.
using Direction = std::function<double(double x, double left, double right)>;

std::string panel(const std::string& words, const Direction& direction) {
    std::string facets = line_to("M", shown(-kHalf - kBorder, 0)), smooth, forces;
    for (int i = 0; i <= kFacets; ++i)
        facets += line_to("L", shown(vertex(i), arc_height(vertex(i))));
    facets += line_to("L", shown(kHalf + kBorder, 0));
    for (int i = 0; i <= 40; ++i) {
        const double x = kHalf * (i / 20.0 - 1);
        smooth += line_to(i == 0 ? "M" : "L", shown(x, arc_height(x)));
    }
    for (int i = 0; i < kFacets; ++i)
        for (const double share : {1 / 6.0, 0.5, 5 / 6.0}) {
            const double left = vertex(i), right = vertex(i + 1), x = left + share * (right - left);
            const double z = arc_height(left) + share * (arc_height(right) - arc_height(left));
            const double tilt = direction(x, left, right), size = std::hypot(1, tilt);
            forces += arrow(shown(x, z), tilt / size, 1 / size);
        }
    // Readers of HTML know the attribute by its small letters, too.
    return fmt::format(
        "<figure class=\"surface\"><svg viewbox=\"0 0 {} {}\" role=\"img\" aria-label=\"{}\"><path class=\"smooth\" "
        "d=\"{}\"></path><path class=\"facets\" d=\"{}\"></path><path class=\"forces\" d=\"{}\"></path></svg>"
        "<figcaption>{}</figcaption></figure>\n",
        kWidth, kHeight, words, smooth, facets, forces, words);
}

} // namespace

std::string surfaces_drawing() {
    return "<div class=\"surfaces\">\n" +
           panel("unshaded: the force jumps from facet to facet",
                 [](double, double left, double right) {
                     return (arc_height(left) - arc_height(right)) / (right - left);
                 }) +
           panel("shaded: as large, and turned to the smooth shape (dashed)",
                 [](double x, double, double) { return x / std::sqrt(kRadius * kRadius - x * x); }) +
           "</div>\n";
}

} // namespace forceshade::report
