// Work of a force on the probe along lines and round closed loops.
#pragma once

#include <functional>
#include <vector>

#include "host/reference/elementary.h"

namespace forceshade::study {

using Vector = reference::Vector<double>;
/// The force, N, on a probe at a place, m.
using ForceAt = std::function<Vector(const Vector& place)>;

struct Work {
    double work = 0;   /* J: done on the probe, the integral of F . dl */
    double effort = 0; /* J: the integral of |F . dl| */
};
Work& operator+=(Work& sum, const Work& more);

/// Where a leg is cut, and how finely.
struct Pieces {
    int count = 16; /* equal ones of each smooth arc; each has 20 nodes */
};

/// Along the straight line, by Gauss-Legendre quadrature of order 20; exact to rounding where the force is smooth.
Work work_along(const ForceAt& force, const Vector& from, const Vector& to, Pieces pieces = {});

/// Along the closed polygon of straight lines through the corners, the last one joined with the first.
Work work_round(const ForceAt& force, const std::vector<Vector>& corners, Pieces pieces = {});

/// A surface cut by a plane of constant y: z = height(x), smooth between the breaks.
struct Section {
    std::vector<double> breaks;           /* m: ascending, where the loop begins and ends included */
    std::function<double(double)> height; /* m */
    std::function<double(double)> slope;  /* 1 */
    double y = 0;                         /* m */

    Vector below(double x, double depth) const { return {x, y, height(x) - depth}; }
};

/// Below the section from its first break to its last at the depth `out`, up or down to the depth `back`, back there,
/// and to where it began; depths in m, vertical.
Work work_round(const ForceAt& force, const Section& section, double out, double back, Pieces pieces = {});

/// Below the section from its first break to its last, or back, at this depth in m.
Work work_leg(const ForceAt& force, const Section& section, double depth, bool returning, Pieces pieces = {});

/// use(place, weight) at the nodes of the leg below the section at this depth, weights in m of x.
void over_leg(const Section& section, double depth, Pieces pieces,
              const std::function<void(const Vector& place, double weight)>& use);

} // namespace forceshade::study
