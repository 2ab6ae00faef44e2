// Where paths go: what a scene leaves open about its paths follows from its surface.
#pragma once

#include <array>

#include "host/prepare/prepared_case.h"

namespace forceshade {

struct PathRegion {
    std::array<double, 2> centre{}; /* m */
    double height = 0;              /* m: z that depth is measured from */
    double length = 0;              /* m: along the heading */
    double width = 0;               /* m: across */
    double inner = 0;               /* m: a spiral's smallest radius */
    double bound = 0;               /* m: a probe further than this from its target has left */
    double stretch = 0;             /* m: the least way that a turn of the force is counted over */
};

/// The region of a scene's paths. Left open: about the origin, or the middle of a mesh's box; 1.2 times as long as the
/// feature is wide along x (of a sine a wavelength, of a Gaussian 4 radii, of an image its size), as wide as long (of
/// a mesh and an image 1.2 times their width along y), but half of a mesh's box for a hand that presses and would fall
/// off its rim; height 0 or the box's top. The stretch is a thousandth of the length; where that is 0 of the width, or
/// of the length that would follow from the feature. \throws UsageError for a spiral whose smallest radius is larger
/// than its largest.
PathRegion path_region(const PathsSpec& paths, const PreparedCase& prepared);

/// That of paths which a file gives in place of the scene's.
PathRegion recorded_region(const PreparedCase& prepared);

/// The stretch, m, as kernels have it in either precision: its square is a number of single precision.
float single_stretch(const PathRegion& region);

/// The largest coordinate, m, that a path may come to: of a normal distribution 8 standard deviations are counted, and
/// of a closed loop what its bound allows.
double farthest_coordinate(const PathsSpec& paths, const PathRegion& region);

} // namespace forceshade
