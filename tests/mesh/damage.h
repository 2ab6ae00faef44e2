// Closed triangle meshes damaged in ways that leave the shape as it is.
#pragma once

#include <cstdint>
#include <random>

#include "host/mesh/mesh.h"

namespace forceshade::shapes {

struct Damage {
    unsigned caps = 0;    /* edges cut in two on one side only, the gap closed by a facet without area */
    unsigned needles = 0; /* corners doubled, the slits closed by needles of no width */
    unsigned repeats = 0; /* facets given once more, from any corner on, half of them with vertices of their own */
    unsigned strays = 0;  /* likewise, but turned over */
    bool shuffled = true; /* the facets' order */
};

/// Coordinates become multiples of 2^-20 first, so that the middle of an edge is exact for some thirty cuts. Cuts and
/// needles meet earlier ones at random: there are chains of caps, caps on both sides of an edge, and needles of caps.
PolygonSoup damaged(PolygonSoup triangles, const Damage& damage, std::mt19937& random);

/// What `damaged` leaves as it is: the coordinates rounded.
PolygonSoup rounded(PolygonSoup polygons);

/// A sphere of 20 * 4^levels facets with lumps and dents.
PolygonSoup lumpy_sphere(unsigned levels, std::mt19937& random);

} // namespace forceshade::shapes
