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

} // namespace forceshade::study
