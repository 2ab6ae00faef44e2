// What rounding lets one expect of a force: the conditions, as formulas.
#pragma once

#include <cmath>
#include <string>
#include <vector>

#include "host/prepare/prepared_case.h"
#include "host/study/energy/loop_work.h"

namespace forceshade::study {

inline double size_of(const Vector& v) {
    return std::hypot(v.x, v.y, v.z);
}

struct Expected {
    double most = 0;       /* N: of all voxels so far */
    std::string condition; /* what weighs most there */
};

/// Adds the voxels of a field at `places` (m), whose forces are those of `home` at `home_places`. With u the unit
/// roundoff, s the slope of the surface, U its height, d the depth, F the force and P the coordinates of a mesh in its
/// own frame, of scale S, a force is off by about the sum of
///  - 4 u F: its own arithmetic;
///  - K u (|z| + s |x|), and of a sine of wavelength l also twice F s 2 pi / l u |x|: its place is rounded;
///  - 2 K u U: depth is a difference of heights; of a mesh K u S (1 + |P|) for all of both;
///  - 2 K 2^-53 D on a mesh D away from the origin, whose vertices are rounded to double;
///  - 2 F d / R times the angle between facets of a mesh so fine that rounding decides which is the nearest;
///  - twice the least number that there is, and all of it where F is beyond the largest.
void add_expected(const PreparedCase& prepared, const PreparedCase& home, const std::vector<Vector>& home_places,
                  const std::vector<Vector>& places, Precision precision, Expected& expected);

} // namespace forceshade::study
