#include "tests/unit/closed_forms.h"

#include <algorithm>
#include <cmath>

#include "host/reference/elementary.h"

namespace forceshade::study {
namespace {

double squares(const BumpLoop& loop) {
    return 0.5 * loop.stiffness * (loop.out * loop.out - loop.back * loop.back);
}

/// The chord of the circle over [left, right].
double chord_slope(double radius, double left, double right) {
    return -(left + right) / (reference::circle_rise(radius, left) + reference::circle_rise(radius, right));
}

double cosine(double slope) {
    return 1 / std::sqrt(1 + slope * slope);
}

/// The integral of N_z = sqrt(R^2 - x^2) / R from 0 to x, m.
double upward(double radius, double x) {
    return (x * reference::circle_rise(radius, x) + radius * radius * std::asin(x / radius)) / (2 * radius);
}

/// use(from, to, slope) for each facet's part within [0, x1], from left to right.
template <typename Use> void over_facets(const BumpLoop& loop, std::span<const double> vertices, const Use& use) {
    for (std::size_t i = 0; i + 1 < vertices.size(); ++i) {
        const double from = std::max(vertices[i], 0.0), to = std::min(vertices[i + 1], loop.end);
        if (from < to)
            use(from, to, chord_slope(loop.radius, vertices[i], vertices[i + 1]));
    }
}

} // namespace

double shaded_plane_work(const BumpLoop& loop) {
    return loop.stiffness * (loop.out - loop.back) * loop.end * loop.end / (2 * loop.radius) +
           squares(loop) * (reference::circle_rise(loop.radius, loop.end) / loop.radius - 1);
}

double two_pass_plane_work(const BumpLoop& loop) {
    return loop.stiffness * (loop.out - loop.back) * (loop.radius - reference::circle_rise(loop.radius, loop.end));
}

double faceted_work(const BumpLoop& loop, std::span<const double> vertices, bool normal_depth) {
    double sum = 0, before = 0;
    bool first = true;
    over_facets(loop, vertices, [&](double, double, double slope) {
        const double c = normal_depth ? 1 / (1 + slope * slope) : cosine(slope);
        sum += first ? 0 : c - before;
        before = c;
        first = false;
    });
    return squares(loop) * sum;
}

double shaded_facets_work(const BumpLoop& loop, std::span<const double> vertices, bool normal_depth) {
    const double radius = loop.radius;
    double along = 0, first = 0, last = 0;
    bool begun = false;
    over_facets(loop, vertices, [&](double from, double to, double slope) {
        const double c = normal_depth ? cosine(slope) : 1;
        along += c * ((to - from) * (to + from) / (2 * radius) + slope * (upward(radius, to) - upward(radius, from)));
        first = begun ? first : c;
        begun = true;
        last = c;
    });
    return loop.stiffness * (loop.out - loop.back) * along +
           squares(loop) * (last * reference::circle_rise(radius, loop.end) / radius - first);
}

} // namespace forceshade::study
