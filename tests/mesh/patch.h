// Meshes of patches of smooth surfaces, as the table of L7 has them.
#pragma once

#include <functional>

#include "host/mesh/mesh.h"

namespace forceshade::study {

enum class Cells { triangles, quads, hexagons };

/// The patch [-1/2, 1/2]^2 cut into `cells` cells a side and lifted to z = height(x, y), as in the table of L7:
/// diagonals from (i, j) to (i + 1, j + 1); regular hexagons 1 / cells wide whose centres lie in the square.
PolygonSoup patch(Cells kind, unsigned cells, const std::function<double(double, double)>& height);

} // namespace forceshade::study
