// Meshes out of bytes, and what must hold of any mesh.
#pragma once

#include "host/mesh/mesh.h"
#include "tests/fuzz/fuzz.h"

namespace forceshade::fuzz {

/// Indices in range, facets of three corners or more, every coordinate finite.
void check_sound(const PolygonSoup& soup);

/// Up to 24 vertices and 40 facets, on a lattice for the most part: duplicates, slivers, folds, facets in facets.
PolygonSoup take_soup(Bytes& bytes);

/// A closed solid of simple shape whose vertices were moved: mostly one that does not touch itself.
PolygonSoup take_solid(Bytes& bytes);

/// Looks at polygons, prepares them, builds their tree, and holds what it says at some places against loops over all
/// triangles. What the program refuses is passed over.
void check_preparation(const PolygonSoup& soup, Bytes& bytes);

} // namespace forceshade::fuzz
