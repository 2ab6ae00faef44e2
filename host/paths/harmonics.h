// Sums of harmonics: the whole of a random walk, the tremor of other paths.
#pragma once

#include <array>
#include <vector>

#include "host/paths/draws.h"
#include "host/paths/region.h"

namespace forceshade {

struct Harmonic {
    double amplitude = 0;         /* m */
    std::uint32_t phase = 0;      /* at step 0 */
    std::uint32_t phase_step = 0; /* a sample */
};

/// Of x, y and z.
using Harmonics = std::vector<std::array<Harmonic, 3>>;

/// How many harmonics each axis of a scene's paths has.
std::uint32_t harmonic_count(const PathsSpec& paths);

/// Those of a path. A random walk has 16 of equal size on x and y, their frequencies anywhere in 16 equal bands from 0
/// to an edge, so that its root mean square is length / sqrt(8) along x, width / sqrt(8) along y, and its speed's is
/// the path's speed; where that leaves the region, the walk turns round (reference::turned_round), which leaves its
/// speed, and 0.275 of length and width. Tremor has 4 of equal size on each axis, their frequencies anywhere in 4 equal
/// bands within 20 % of its own.
Harmonics path_harmonics(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

/// Above every frequency of a scene's tremor, Hz.
double highest_tremor(const PathsSpec& paths);

/// The edge of a random walk's band, turns a sample: above every frequency of it.
double walk_edge(const PathsSpec& paths, const PathRegion& region, const PathDraws& draws);

} // namespace forceshade
