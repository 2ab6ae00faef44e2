// Random scenes of 64 x 16 x 32 voxels over every law and option, the same on every machine. Written as TOML, so that
// each is one that a user could have asked for.
#pragma once

#include <cstdint>

#include "host/field/prepared_case.h"

namespace forceshade::test {

/// How far the scenes go.
enum class Conditioning {
    anything, /* n to 10^6, R/a from 1 to 10^9, K from 1e-9 to 1e12 N/m, grids tiny, near and far */
    moderate, /* shapes for a hand, n to 100, R/a from 1.01 to 100, grids around the shape */
};

/// The scene of a seed, with its images, if any, in memory only.
PreparedCase random_scene(std::uint64_t seed, Conditioning conditioning);

} // namespace forceshade::test
